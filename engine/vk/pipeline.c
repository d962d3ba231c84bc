/* Descriptor sets, pipeline layouts, compute and graphics pipelines. */
#include "vk.h"

#include <string.h>

/* Pool sizes of set_count sets, one entry per distinct descriptor type. */
static uint32_t pool_sizes(const VkDescriptorType *type, uint32_t binding_count, uint32_t set_count,
                           VkDescriptorPoolSize *out)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < binding_count; i++) {
        uint32_t k = 0;
        while (k < count && out[k].type != type[i]) {
            k++;
        }
        if (k == count) {
            out[count++] = (VkDescriptorPoolSize){type[i], 0};
        }
        out[k].descriptorCount += set_count;
    }
    return count;
}

ris_result ris_vk_sets_create(ris_device *vk, const VkDescriptorType *type, uint32_t binding_count,
                              VkShaderStageFlags stages, uint32_t set_count, ris_vk_sets *out, ris_error *err)
{
    ris_result result = RIS_OK;
    VkDescriptorSetLayoutBinding binding[32] = {0};
    VkDescriptorPoolSize size[32];
    VkDescriptorSetLayout layouts[8];
    VkDescriptorSetLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                              .bindingCount = binding_count,
                                              .pBindings = binding};
    VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = set_count, .pPoolSizes = size};
    VkDescriptorSetAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                            .descriptorSetCount = set_count,
                                            .pSetLayouts = layouts};
    memset(out, 0, sizeof *out);
    if (binding_count == 0 || binding_count > 32 || set_count == 0 || set_count > 8) {
        return ris_fail(err, RIS_ERROR_DEVICE, "%u bindings in %u sets, expected 1..32 in 1..8",
                        binding_count, set_count);
    }
    for (uint32_t i = 0; i < binding_count; i++) {
        binding[i] = (VkDescriptorSetLayoutBinding){
            .binding = i, .descriptorType = type[i], .descriptorCount = 1, .stageFlags = stages};
        out->type[i] = type[i];
    }
    pool.poolSizeCount = pool_sizes(type, binding_count, set_count, size);
    RIS_VK(vkCreateDescriptorSetLayout(vk->handle, &layout, NULL, &out->layout));
    RIS_VK(vkCreateDescriptorPool(vk->handle, &pool, NULL, &out->pool));
    for (uint32_t i = 0; i < set_count; i++) {
        layouts[i] = out->layout;
    }
    allocate.descriptorPool = out->pool;
    RIS_VK(vkAllocateDescriptorSets(vk->handle, &allocate, out->set));
    out->set_count = set_count;
    out->binding_count = binding_count;
    return RIS_OK;
fail:
    ris_vk_sets_finish(vk, out);
    return result;
}

void ris_vk_sets_finish(ris_device *vk, ris_vk_sets *sets)
{
    if (sets->pool) {
        vkDestroyDescriptorPool(vk->handle, sets->pool, NULL);
    }
    if (sets->layout) {
        vkDestroyDescriptorSetLayout(vk->handle, sets->layout, NULL);
    }
    memset(sets, 0, sizeof *sets);
}

void ris_vk_sets_write_buffer(ris_device *vk, const ris_vk_sets *sets, uint32_t set, uint32_t binding,
                              VkBuffer buffer, VkDeviceSize offset, VkDeviceSize size)
{
    VkDescriptorBufferInfo info = {buffer, offset, size};
    VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                  .dstSet = sets->set[set],
                                  .dstBinding = binding,
                                  .descriptorCount = 1,
                                  .descriptorType = sets->type[binding],
                                  .pBufferInfo = &info};
    vkUpdateDescriptorSets(vk->handle, 1, &write, 0, NULL);
}

void ris_vk_sets_write_texels(ris_device *vk, const ris_vk_sets *sets, uint32_t set, uint32_t binding,
                              VkBufferView view)
{
    VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                  .dstSet = sets->set[set],
                                  .dstBinding = binding,
                                  .descriptorCount = 1,
                                  .descriptorType = sets->type[binding],
                                  .pTexelBufferView = &view};
    vkUpdateDescriptorSets(vk->handle, 1, &write, 0, NULL);
}

void ris_vk_sets_write_image(ris_device *vk, const ris_vk_sets *sets, uint32_t set, uint32_t binding,
                             VkImageView view, VkImageLayout layout, VkSampler sampler)
{
    VkDescriptorImageInfo info = {sampler, view, layout};
    VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                  .dstSet = sets->set[set],
                                  .dstBinding = binding,
                                  .descriptorCount = 1,
                                  .descriptorType = sets->type[binding],
                                  .pImageInfo = &info};
    vkUpdateDescriptorSets(vk->handle, 1, &write, 0, NULL);
}

ris_result ris_vk_layout_create(ris_device *vk, VkDescriptorSetLayout set, VkShaderStageFlags push_stages,
                                uint32_t push_size, VkPipelineLayout *out, ris_error *err)
{
    ris_result result = RIS_OK;
    VkPushConstantRange push = {push_stages, 0, push_size};
    VkPipelineLayoutCreateInfo info = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                       .setLayoutCount = set ? 1 : 0,
                                       .pSetLayouts = &set,
                                       .pushConstantRangeCount = push_size ? 1 : 0,
                                       .pPushConstantRanges = &push};
    *out = VK_NULL_HANDLE;
    RIS_VK(vkCreatePipelineLayout(vk->handle, &info, NULL, out));
fail:
    return result;
}

static ris_result create_module(ris_device *vk, ris_vk_code code, VkShaderModule *out, ris_error *err)
{
    ris_result result = RIS_OK;
    VkShaderModuleCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = code.size, .pCode = code.words};
    RIS_VK(vkCreateShaderModule(vk->handle, &info, NULL, out));
fail:
    return result;
}

ris_result ris_vk_compute_create(ris_device *vk, VkPipelineLayout layout, ris_vk_code code,
                                 const VkSpecializationInfo *constants, const char *name, VkPipeline *out,
                                 ris_error *err)
{
    ris_result result = RIS_OK;
    VkShaderModule module = VK_NULL_HANDLE;
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .layout = layout,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .pName = "main",
                  .pSpecializationInfo = constants}};
    *out = VK_NULL_HANDLE;
    RIS_TRY(create_module(vk, code, &module, err));
    info.stage.module = module;
    RIS_VK(vkCreateComputePipelines(vk->handle, VK_NULL_HANDLE, 1, &info, NULL, out));
    ris_vk_name(vk, VK_OBJECT_TYPE_PIPELINE, (uint64_t)*out, name);
fail:
    vkDestroyShaderModule(vk->handle, module, NULL);
    return result;
}

static const VkPipelineColorBlendAttachmentState blend_over = {
    .blendEnable = VK_TRUE,
    .srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA,
    .dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
    .srcAlphaBlendFactor = VK_BLEND_FACTOR_ONE,
    .dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA,
    .colorWriteMask = 0xf,
};
static const VkPipelineColorBlendAttachmentState blend_none = {.colorWriteMask = 0xf};

/* The fixed-function state of def around two modules. */
static ris_result create_graphics(ris_device *vk, const ris_vk_graphics_def *def,
                                  const VkPipelineShaderStageCreateInfo *stages, VkPipeline *out,
                                  ris_error *err)
{
    ris_result result = RIS_OK;
    const VkDynamicState dynamics[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    const VkPipelineVertexInputStateCreateInfo input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = def->vertex_binding_count,
        .pVertexBindingDescriptions = def->vertex_binding,
        .vertexAttributeDescriptionCount = def->vertex_attribute_count,
        .pVertexAttributeDescriptions = def->vertex_attribute};
    const VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO, .topology = def->topology};
    const VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    const VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = vk->features.fillModeNonSolid ? def->polygon : VK_POLYGON_MODE_FILL,
        .cullMode = def->cull,
        .frontFace = def->front_clockwise ? VK_FRONT_FACE_CLOCKWISE : VK_FRONT_FACE_COUNTER_CLOCKWISE,
        .lineWidth = def->line_width > 0.0f && vk->features.wideLines ? def->line_width : 1.0f};
    const VkPipelineMultisampleStateCreateInfo multisample = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = def->samples ? def->samples : VK_SAMPLE_COUNT_1_BIT,
        .alphaToCoverageEnable = def->alpha_to_coverage};
    const VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = def->depth_test,
        .depthWriteEnable = def->depth_write,
        .depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL};
    const VkPipelineColorBlendStateCreateInfo blend = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = 1,
        .pAttachments = def->blend ? &blend_over : &blend_none};
    const VkPipelineDynamicStateCreateInfo dynamic = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2,
        .pDynamicStates = dynamics};
    const VkPipelineRenderingCreateInfo rendering = {.sType =
                                                         VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                     .colorAttachmentCount = 1,
                                                     .pColorAttachmentFormats = &def->color_format,
                                                     .depthAttachmentFormat = def->depth_format};
    const VkGraphicsPipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                               .pNext = &rendering,
                                               .stageCount = 2,
                                               .pStages = stages,
                                               .pVertexInputState = &input,
                                               .pInputAssemblyState = &assembly,
                                               .pViewportState = &viewport,
                                               .pRasterizationState = &raster,
                                               .pMultisampleState = &multisample,
                                               .pDepthStencilState = &depth,
                                               .pColorBlendState = &blend,
                                               .pDynamicState = &dynamic,
                                               .layout = def->layout};
    RIS_VK(vkCreateGraphicsPipelines(vk->handle, VK_NULL_HANDLE, 1, &info, NULL, out));
    ris_vk_name(vk, VK_OBJECT_TYPE_PIPELINE, (uint64_t)*out, def->name);
fail:
    return result;
}

ris_result ris_vk_graphics_create(ris_device *vk, const ris_vk_graphics_def *def, VkPipeline *out,
                                  ris_error *err)
{
    ris_result result = RIS_OK;
    VkPipelineShaderStageCreateInfo stages[2] = {
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_VERTEX_BIT,
         .pName = "main"},
        {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
         .stage = VK_SHADER_STAGE_FRAGMENT_BIT,
         .pName = "main"},
    };
    *out = VK_NULL_HANDLE;
    RIS_TRY(create_module(vk, def->vertex, &stages[0].module, err));
    RIS_TRY(create_module(vk, def->fragment, &stages[1].module, err));
    RIS_TRY(create_graphics(vk, def, stages, out, err));
fail:
    vkDestroyShaderModule(vk->handle, stages[0].module, NULL);
    vkDestroyShaderModule(vk->handle, stages[1].module, NULL);
    return result;
}
