/* The Vulkan layer: the only place that creates, frees and submits Vulkan objects for sim/vk and draw.
 * Vulkan 1.3 core (synchronization2, dynamic rendering, maintenance4, scalar layout), one queue for
 * everything. Manners: every function that can fail returns ris_result and names object and cause in err;
 * every *_finish and *_destroy accepts a zeroed or half-built object; handles are VK_NULL_HANDLE until
 * created. One thread per device. */
#pragma once

#include <vulkan/vulkan.h>

#include "risorius/device.h"

/* Longest wait for the device: 60 s, lavapipe under a sanitizer is slow. */
#define RIS_VK_TIMEOUT_NS 60000000000ull

/* ---- device.c ---- */

struct ris_device {
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkDevice handle;
    VkQueue queue; /* graphics + compute + transfer */
    uint32_t family;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceFeatures features; /* those enabled */
    VkPhysicalDeviceMemoryProperties memory;
    VkCommandPool pool;
    ris_device_info info;
    bool present;     /* VK_KHR_swapchain enabled */
    bool debug_utils; /* object names go to the driver */
    bool validation;  /* RIS_VALIDATION=1: validation and synchronization validation are on */
    bool staging;     /* RIS_STAGING=1 (tests): device memory counts as out of the host's reach */
    bool lost;        /* sticky: every later call fails at once */
    uint32_t timestamp_bits;
    uint32_t message_count; /* validation warnings and errors so far */
    char message[1024];     /* the first of them */
    PFN_vkSetDebugUtilsObjectNameEXT set_name;
    PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger;
};

/* Gives a Vulkan object a name for debuggers and validation messages; does nothing without
 * VK_EXT_debug_utils. */
void ris_vk_name(ris_device *vk, VkObjectType type, uint64_t handle, const char *name);
const char *ris_vk_result_name(VkResult result);

/* RIS_VK(call) inside a function that has `ris_device *vk` (may be NULL), `ris_error *err`, `ris_result
 * result` and a label `fail`: on anything but VK_SUCCESS sets result, writes call, result name and
 * file:line to err and goes to fail. */
#define RIS_VK(call)                                                                                         \
    do {                                                                                                     \
        VkResult vk_result_ = ris__vk_gate(vk);                                                              \
        if (vk_result_ == VK_SUCCESS) {                                                                      \
            vk_result_ = (call);                                                                             \
        }                                                                                                    \
        if (vk_result_ != VK_SUCCESS) {                                                                      \
            result = ris__vk_fail(vk, err, vk_result_, #call, __FILE__, __LINE__);                           \
            goto fail;                                                                                       \
        }                                                                                                    \
    } while (0)
/* The same for a function of this layer that returns ris_result (err already written). */
#define RIS_TRY(call)                                                                                        \
    do {                                                                                                     \
        result = (call);                                                                                     \
        if (result != RIS_OK) {                                                                              \
            goto fail;                                                                                       \
        }                                                                                                    \
    } while (0)

/* VK_ERROR_DEVICE_LOST once lost; the injected result when its turn comes. */
VkResult ris__vk_gate(ris_device *vk);
ris_result ris__vk_fail(ris_device *vk, ris_error *err, VkResult result, const char *call, const char *file,
                        int line);

/* Fault injection for tests, per thread: the n-th (from 0) RIS_VK call from now on gives `what` instead of
 * being made. n < 0 switches it off. ris__vk_fault_count() tells how many calls were counted since. */
void ris__vk_fault_set(int64_t n, VkResult what);
int64_t ris__vk_fault_count(void);

/* ---- buffer.c ---- */

typedef enum ris_vk_use {
    RIS_VK_DEVICE,  /* device local, filled and read by staging copies */
    RIS_VK_UPLOAD,  /* host visible, mapped, written by the host and read by the device */
    RIS_VK_READBACK /* host visible, mapped, cached where possible, written by the device, read by the host */
} ris_vk_use;

typedef struct ris_vk_buffer {
    VkBuffer handle;
    VkDeviceMemory memory;
    VkDeviceSize size;
    void *
        data; /* mapped for UPLOAD and READBACK, and for DEVICE where its memory is host visible; else NULL */
    bool coherent;     /* no flush or invalidate needed */
    bool cached;       /* host reads are fast */
    bool device_local; /* memory is on the device */
} ris_vk_buffer;

/* usage is added to TRANSFER_SRC | TRANSFER_DST. Contents are undefined. */
ris_result ris_vk_buffer_create(ris_device *vk, ris_vk_use use, VkDeviceSize size, VkBufferUsageFlags usage,
                                const char *name, ris_vk_buffer *out, ris_error *err);
void ris_vk_buffer_finish(ris_device *vk, ris_vk_buffer *buffer);
/* Makes host writes visible to the next submit / device writes visible to the host after the fence (whole
 * buffer). */
ris_result ris_vk_buffer_flush(ris_device *vk, const ris_vk_buffer *buffer, ris_error *err);
ris_result ris_vk_buffer_invalidate(ris_device *vk, const ris_vk_buffer *buffer, ris_error *err);
/* Blocking copies by a staging buffer (or directly when mapped): for load time and tests, not for frames. */
ris_result ris_vk_buffer_write(ris_device *vk, ris_vk_buffer *buffer, VkDeviceSize offset, const void *data,
                               VkDeviceSize size, ris_error *err);
ris_result ris_vk_buffer_read(ris_device *vk, ris_vk_buffer *buffer, VkDeviceSize offset, void *out,
                              VkDeviceSize size, ris_error *err);
/* Sub-range of a large buffer: returns *cursor aligned for every buffer use and moves *cursor past size
 * bytes. */
VkDeviceSize ris_vk_range(const ris_device *vk, VkDeviceSize *cursor, VkDeviceSize size);
/* Memory type with all of `wanted` (and preferably `preferred`) among type_bits, UINT32_MAX if none. */
uint32_t ris__vk_memory_type(const ris_device *vk, uint32_t type_bits, VkMemoryPropertyFlags wanted,
                             VkMemoryPropertyFlags preferred);

/* ---- image.c ---- */

typedef struct ris_vk_image_def {
    uint32_t width, height;
    VkFormat format;
    uint32_t mip_count;            /* 0 = the full chain, else as given (1 for targets) */
    VkSampleCountFlagBits samples; /* 0 = 1 */
    VkImageUsageFlags usage;
    VkImageAspectFlags aspect; /* 0 = colour */
    const char *name;
} ris_vk_image_def;

typedef struct ris_vk_image {
    VkImage handle;
    VkDeviceMemory memory;
    VkImageView view; /* all mips */
    VkFormat format;
    VkImageAspectFlags aspect;
    uint32_t width, height, mip_count;
} ris_vk_image;

ris_result ris_vk_image_create(ris_device *vk, const ris_vk_image_def *def, ris_vk_image *out,
                               ris_error *err);
void ris_vk_image_finish(ris_device *vk, ris_vk_image *image);
/* Uploads tightly packed level 0 (4 bytes a pixel), makes the other levels by linear blits and leaves
 * every level in SHADER_READ_ONLY_OPTIMAL. The image needs TRANSFER_DST and, with mips, TRANSFER_SRC
 * usage. Blocking. */
ris_result ris_vk_image_upload(ris_device *vk, ris_vk_image *image, const void *pixels, ris_error *err);
/* Linear (trilinear, anisotropic up to `anisotropy` where the device can; 0 = off) sampler. */
ris_result ris_vk_sampler_create(ris_device *vk, VkSamplerAddressMode address, float anisotropy,
                                 VkSampler *out, ris_error *err);

typedef struct ris_vk_access {
    VkPipelineStageFlags2 stage;
    VkAccessFlags2 access;
    VkImageLayout layout; /* of images only */
} ris_vk_access;

/* Layout change and dependency for some levels of an image. */
void ris_vk_range_barrier(VkCommandBuffer cmd, VkImage image, VkImageSubresourceRange range,
                          ris_vk_access from, ris_vk_access to);
/* The same for all levels. */
void ris_vk_image_barrier(VkCommandBuffer cmd, VkImage image, VkImageAspectFlags aspect, ris_vk_access from,
                          ris_vk_access to);

/* ---- cmd.c ---- */

/* Global memory barrier: everything in src done and visible to dst. */
void ris_vk_barrier(VkCommandBuffer cmd, VkPipelineStageFlags2 src_stage, VkAccessFlags2 src_access,
                    VkPipelineStageFlags2 dst_stage, VkAccessFlags2 dst_access);

/* A command buffer with its fence. Record between begin and end; submit any number of times; one submit in
 * flight. */
typedef struct ris_vk_cmd {
    VkCommandBuffer handle;
    VkFence fence;
    bool pending; /* submitted and not waited for */
} ris_vk_cmd;

ris_result ris_vk_cmd_create(ris_device *vk, const char *name, ris_vk_cmd *out, ris_error *err);
void ris_vk_cmd_finish(ris_device *vk, ris_vk_cmd *cmd); /* waits if pending */
/* one_time: recorded anew for every submit (a hint); waits first if pending. */
ris_result ris_vk_cmd_begin(ris_device *vk, ris_vk_cmd *cmd, bool one_time, ris_error *err);
ris_result ris_vk_cmd_end(ris_device *vk, ris_vk_cmd *cmd, ris_error *err);
/* wait/signal may be VK_NULL_HANDLE. wait blocks all commands of the buffer. */
ris_result ris_vk_cmd_submit(ris_device *vk, ris_vk_cmd *cmd, VkSemaphore wait, VkSemaphore signal,
                             ris_error *err);
/* Waits for the fence, at most RIS_VK_TIMEOUT_NS (then RIS_ERROR_DEVICE and the device counts as lost). */
ris_result ris_vk_cmd_wait(ris_device *vk, ris_vk_cmd *cmd, ris_error *err);
/* begin(one_time) .. record .. ris_vk_cmd_run = end + submit + wait. */
ris_result ris_vk_cmd_run(ris_device *vk, ris_vk_cmd *cmd, ris_error *err);

/* Timestamps; count 0 or a device without them gives an empty object whose functions do nothing. */
typedef struct ris_vk_query {
    VkQueryPool pool;
    uint32_t count;
    double tick_ms; /* milliseconds per tick */
    uint64_t mask;
} ris_vk_query;

ris_result ris_vk_query_create(ris_device *vk, uint32_t count, ris_vk_query *out, ris_error *err);
void ris_vk_query_finish(ris_device *vk, ris_vk_query *query);
void ris_vk_query_reset(VkCommandBuffer cmd, const ris_vk_query *query);
void ris_vk_query_write(VkCommandBuffer cmd, const ris_vk_query *query, uint32_t index);
/* Raw ticks after the fence (count); milliseconds = ((b - a) & mask) * tick_ms. */
ris_result ris_vk_query_read(ris_device *vk, const ris_vk_query *query, uint64_t *out, ris_error *err);

/* ---- pipeline.c ---- */

/* Descriptors: one layout, one pool, set_count sets of it. Binding i has type[i]. */
typedef struct ris_vk_sets {
    VkDescriptorSetLayout layout;
    VkDescriptorPool pool;
    VkDescriptorSet set[8];
    uint32_t set_count, binding_count;
    VkDescriptorType type[32];
} ris_vk_sets;

ris_result ris_vk_sets_create(ris_device *vk, const VkDescriptorType *type, uint32_t binding_count,
                              VkShaderStageFlags stages, uint32_t set_count, ris_vk_sets *out,
                              ris_error *err);
void ris_vk_sets_finish(ris_device *vk, ris_vk_sets *sets);
void ris_vk_sets_write_texels(ris_device *vk, const ris_vk_sets *sets, uint32_t set, uint32_t binding,
                              VkBufferView view);
void ris_vk_sets_write_buffer(ris_device *vk, const ris_vk_sets *sets, uint32_t set, uint32_t binding,
                              VkBuffer buffer, VkDeviceSize offset, VkDeviceSize size);
/* sampler may be VK_NULL_HANDLE for a storage image. */
void ris_vk_sets_write_image(ris_device *vk, const ris_vk_sets *sets, uint32_t set, uint32_t binding,
                             VkImageView view, VkImageLayout layout, VkSampler sampler);

/* Layout of one set layout (VK_NULL_HANDLE = none) and push_size bytes of push constants at offset 0. */
ris_result ris_vk_layout_create(ris_device *vk, VkDescriptorSetLayout set, VkShaderStageFlags push_stages,
                                uint32_t push_size, VkPipelineLayout *out, ris_error *err);

/* SPIR-V words as the build embeds them (ris_spv_<name>_<kind>), size in bytes. */
typedef struct ris_vk_code {
    const uint32_t *words;
    size_t size;
} ris_vk_code;
#define RIS_VK_CODE(array) ((ris_vk_code){(array), sizeof(array)})

/* constants: of the specialization, NULL = as the shader has them. */
ris_result ris_vk_compute_create(ris_device *vk, VkPipelineLayout layout, ris_vk_code code,
                                 const VkSpecializationInfo *constants, const char *name, VkPipeline *out,
                                 ris_error *err);

/* Viewport and scissor are dynamic. depth_format VK_FORMAT_UNDEFINED = no depth. */
typedef struct ris_vk_graphics_def {
    VkPipelineLayout layout;
    ris_vk_code vertex, fragment;
    const VkVertexInputBindingDescription *vertex_binding;
    uint32_t vertex_binding_count; /* 0 = vertices pulled from storage buffers */
    const VkVertexInputAttributeDescription *vertex_attribute;
    uint32_t vertex_attribute_count;
    VkPrimitiveTopology topology;
    VkPolygonMode polygon; /* VK_POLYGON_MODE_LINE falls back to fill where the device cannot */
    VkCullModeFlags cull;  /* front = counter-clockwise in framebuffer space unless front_clockwise */
    bool front_clockwise;
    bool depth_test, depth_write, blend; /* blend: src alpha over */
    bool alpha_to_coverage;
    VkSampleCountFlagBits samples;
    VkFormat color_format, depth_format;
    float line_width; /* 0 = 1 */
    const char *name;
} ris_vk_graphics_def;

ris_result ris_vk_graphics_create(ris_device *vk, const ris_vk_graphics_def *def, VkPipeline *out,
                                  ris_error *err);

/* ---- swapchain.c ---- */

/* Shows images in a window. Owns the surface from create on, success or not. */
typedef struct ris_vk_swapchain ris_vk_swapchain;

/* surface: made by the window library with vk->instance; the device must have been created with present =
 * true. */
ris_result ris_vk_swapchain_create(ris_device *vk, VkSurfaceKHR surface, uint32_t width, uint32_t height,
                                   ris_vk_swapchain **out, ris_error *err);
/* Blits source (single-sampled colour image of source_width x source_height, present layout and access in
 * `from`, left in TRANSFER_SRC_OPTIMAL) over the whole window and presents it. width and height are the
 * window's present size; when it or the surface changed, the swapchain is rebuilt; 0 in either (minimised)
 * skips and returns RIS_OK. Blocks until the blit is done, so that source may be drawn to again. */
ris_result ris_vk_swapchain_present(ris_vk_swapchain *swapchain, VkImage source, ris_vk_access from,
                                    uint32_t source_width, uint32_t source_height, uint32_t width,
                                    uint32_t height, ris_error *err);
void ris_vk_swapchain_destroy(ris_vk_swapchain *swapchain);
