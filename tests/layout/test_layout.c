/* Walks the SPIR-V of every simulation stage (built with -g, so that names are in it) and compares member
 * offsets, array strides, bindings and group sizes with the C side of sim_shared.h; and that every float
 * operation is marked NoContraction, without which no device owes us the CPU's bits. Then spoils each of
 * these words in turn, which must be noticed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sim_shared.h"

enum {
    OP_NAME = 5,
    OP_MEMBER_NAME = 6,
    OP_EXECUTION_MODE_ID = 331,
    OP_CONSTANT = 43,
    OP_TYPE_ARRAY = 28,
    OP_TYPE_RUNTIME_ARRAY = 29,
    OP_TYPE_STRUCT = 30,
    OP_TYPE_POINTER = 32,
    OP_VARIABLE = 59,
    OP_DECORATE = 71,
    OP_MEMBER_DECORATE = 72,
    OP_FADD = 129,
    OP_FSUB = 131,
    OP_FMUL = 133,
    OP_FDIV = 136,
    OP_VECTOR_TIMES_SCALAR = 142,
    OP_DOT = 148
};
enum {
    DECORATION_ARRAY_STRIDE = 6,
    DECORATION_BINDING = 33,
    DECORATION_SET = 34,
    DECORATION_OFFSET = 35,
    DECORATION_NO_CONTRACTION = 42
};
enum {
    MODE_LOCAL_SIZE_ID = 38,
    STORAGE_PUSH_CONSTANT = 9,
    STORAGE_BUFFER = 12,
    STORAGE_UNIFORM = 2,
    STORAGE_TEXELS = 0
};

#define MEMBERS 16u
#define NONE UINT32_MAX

/* What the C side says. */
typedef struct field {
    const char *type, *member;
    uint32_t offset;
} field;
#define FIELD(type, member)                                                                                  \
    {                                                                                                        \
#type, #member, (uint32_t)offsetof(type, member)                                                     \
    }
static const field fields[] = {
    FIELD(ris_half_spring, other),
    FIELD(ris_half_spring, rest_mm),
    FIELD(ris_half_spring, area_ratio),
    FIELD(ris_half_spring, bend_out),
    FIELD(ris_half_spring, bend_in),
    FIELD(ris_ring, b),
    FIELD(ris_ring, c),
    FIELD(ris_anchor_param, normal),
    FIELD(ris_anchor_param, tangential),
    FIELD(ris_anchor_param, rest_mm),
    FIELD(ris_anchor_param, bend),
    FIELD(ris_anchor_point, a),
    FIELD(ris_anchor_point, b),
    FIELD(ris_sim_push, node_count),
    FIELD(ris_sim_push, flags),
    FIELD(ris_sim_push, dt_s),
    FIELD(ris_sim_push, modulus_low),
    FIELD(ris_sim_push, modulus_high),
    FIELD(ris_sim_push, switch_stretch),
    FIELD(ris_sim_push, compression),
    FIELD(ris_sim_push, damping_per_s),
    FIELD(ris_sim_push, contact_node_count),
    FIELD(ris_sim_push, lip_node_count),
    FIELD(ris_sim_push, lip_radius_mm),
    FIELD(ris_sim_push, moving_count),
    FIELD(ris_contact_node, node),
    FIELD(ris_contact_node, lip_first),
    FIELD(ris_contact_node, lip_end),
    FIELD(ris_contact_node, lip_limit_mm),
    FIELD(ris_contact_node, touch_first),
    FIELD(ris_contact_node, touch_end),
    FIELD(ris_contact_touch, body),
    FIELD(ris_contact_touch, other),
    FIELD(ris_contact_touch, limit_mm),
    FIELD(ris_contact_body, row_x),
    FIELD(ris_contact_body, row_y),
    FIELD(ris_contact_body, row_z),
    FIELD(ris_contact_body, low),
    FIELD(ris_contact_body, count_x),
    FIELD(ris_contact_body, count_y),
    FIELD(ris_contact_body, count_z),
    FIELD(ris_contact_body, first),
    FIELD(ris_inertia, row_x),
    FIELD(ris_inertia, row_y),
    FIELD(ris_inertia, row_z),
};
#define FIELD_COUNT (sizeof fields / sizeof fields[0])

typedef struct block {
    const char *name;
    uint32_t binding, stride;
} block;
static const block blocks[] = {
    {"position_block", RIS_BIND_POSITION, sizeof(ris_vec4)},
    {"rest_block", RIS_BIND_REST, sizeof(ris_vec4)},
    {"velocity_half_block", RIS_BIND_VELOCITY_HALF, sizeof(ris_vec4)},
    {"velocity_prev_block", RIS_BIND_VELOCITY_PREV, sizeof(ris_vec4)},
    {"force_block", RIS_BIND_FORCE, sizeof(ris_vec4)},
    {"bend_block", RIS_BIND_BEND, sizeof(ris_vec4)},
    {"normal_block", RIS_BIND_NORMAL, sizeof(ris_vec4)},
    {"spring_start_block", RIS_BIND_SPRING_START, sizeof(uint32_t)},
    {"half_spring_block", RIS_BIND_HALF_SPRING, sizeof(ris_half_spring)},
    {"ring_start_block", RIS_BIND_RING_START, sizeof(uint32_t)},
    {"ring_block", RIS_BIND_RING, sizeof(ris_ring)},
    {"anchor_param_block", RIS_BIND_ANCHOR_PARAM, sizeof(ris_anchor_param)},
    {"anchor_point_block", RIS_BIND_ANCHOR_POINT, sizeof(ris_anchor_point)},
    {"anchor_delta_block", RIS_BIND_ANCHOR_DELTA, sizeof(ris_vec4)},
    {"free_block", RIS_BIND_FREE, sizeof(ris_vec4)},
    {"contact_node_block", RIS_BIND_CONTACT_NODE, sizeof(ris_contact_node)},
    {"contact_touch_block", RIS_BIND_CONTACT_TOUCH, sizeof(ris_contact_touch)},
    {"contact_other_block", RIS_BIND_CONTACT_OTHER, sizeof(uint32_t)},
    {"contact_grid_block", RIS_BIND_CONTACT_GRID, sizeof(ris_vec4)},
    {"contact_body_block", RIS_BIND_CONTACT_BODY, sizeof(ris_contact_body)},
    {"inertia_block", RIS_BIND_INERTIA, sizeof(ris_inertia)},
    {"heft_block", RIS_BIND_HEFT, sizeof(float)},
    {"moving_block", RIS_BIND_MOVING, sizeof(uint32_t)},
};
#define BLOCK_COUNT (sizeof blocks / sizeof blocks[0])

static const struct {
    const char *name;
    uint32_t binding;
} texels[] = {
    {"position", RIS_TEXEL_POSITION},
    {"rest", RIS_TEXEL_REST},
    {"bend", RIS_TEXEL_BEND},
    {"normal", RIS_TEXEL_NORMAL},
    {"free_position", RIS_TEXEL_FREE},
    {"contact_grid", RIS_TEXEL_CONTACT_GRID},
    {"half_spring_word", RIS_TEXEL_HALF_SPRING},
};
#define TEXEL_COUNT (sizeof texels / sizeof texels[0])

#define BIT(name) (1u << RIS_BIND_##name)
#define TEXEL(name) (1u << RIS_TEXEL_##name)
static const struct {
    const char *name;
    uint32_t bindings; /* all it declares */
} stages[] = {
    {"anchor_shift", BIT(MOVING) | BIT(POSITION) | BIT(ANCHOR_DELTA)},
    {"bend",
     BIT(MOVING) | TEXEL(POSITION) | TEXEL(REST) | BIT(BEND) | BIT(SPRING_START) | TEXEL(HALF_SPRING)},
    {"spring_force", BIT(MOVING) | TEXEL(POSITION) | BIT(FORCE) | TEXEL(BEND) | BIT(SPRING_START) |
                         TEXEL(HALF_SPRING) | BIT(ANCHOR_PARAM) | BIT(ANCHOR_POINT)},
    {"verlet", BIT(MOVING) | BIT(POSITION) | BIT(VELOCITY_HALF) | BIT(VELOCITY_PREV) | BIT(FORCE) |
                   BIT(FREE) | BIT(INERTIA) | BIT(HEFT)},
    {"lip_normal", TEXEL(FREE) | BIT(NORMAL) | BIT(RING_START) | BIT(RING) | BIT(CONTACT_NODE)},
    {"contact", BIT(POSITION) | BIT(VELOCITY_HALF) | BIT(VELOCITY_PREV) | TEXEL(NORMAL) | TEXEL(FREE) |
                    BIT(CONTACT_NODE) | BIT(CONTACT_TOUCH) | BIT(CONTACT_OTHER) | TEXEL(CONTACT_GRID) |
                    BIT(CONTACT_BODY)},
    {"normal", TEXEL(POSITION) | BIT(NORMAL) | BIT(RING_START) | BIT(RING)},
};
#define STAGE_COUNT (sizeof stages / sizeof stages[0])

/* One id of the module; word numbers (not values) where a control spoils them. */
typedef struct entry {
    const char *name, *member[MEMBERS];
    uint32_t opcode, at; /* of the defining instruction */
    uint32_t offset_at[MEMBERS], stride_at, binding_at, set_at, contraction_at;
} entry;

typedef struct module {
    uint32_t *words;
    uint32_t count, bound,
        local_size_id[3]; /* constants that hold the group size: glslang's form for Vulkan 1.3 */
    entry *entry;         /* (bound) */
    char error[256];
} module;

static void read_module(const char *stage, module *m)
{
    char path[1024];
    long size;
    FILE *file;
    snprintf(path, sizeof path, "%s/shaders/sim/%s_comp.spv", RIS_BUILD_DIR, stage);
    file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    size = ftell(file);
    rewind(file);
    memset(m, 0, sizeof *m);
    m->count = (uint32_t)size / 4;
    m->words = malloc((size_t)size);
    assert_non_null(m->words);
    assert_int_equal(fread(m->words, 4, m->count, file), m->count);
    fclose(file);
    assert_int_equal(m->words[0], 0x07230203);
    m->bound = m->words[3];
    m->entry = calloc(m->bound, sizeof *m->entry);
    assert_non_null(m->entry);
}

static void free_module(module *m)
{
    free(m->words);
    free(m->entry);
}

static void index_decoration(module *m, uint32_t at)
{
    entry *e = &m->entry[m->words[at + 1]];
    switch (m->words[at + 2]) {
    case DECORATION_ARRAY_STRIDE: e->stride_at = at + 3; break;
    case DECORATION_BINDING: e->binding_at = at + 3; break;
    case DECORATION_SET: e->set_at = at + 3; break;
    case DECORATION_NO_CONTRACTION: e->contraction_at = at + 2; break;
    default: break;
    }
}

static bool is_float_arithmetic(uint32_t op)
{
    return op == OP_FADD || op == OP_FSUB || op == OP_FMUL || op == OP_FDIV ||
           (op >= OP_VECTOR_TIMES_SCALAR && op <= OP_DOT);
}

static void index_instruction(module *m, uint32_t at)
{
    const uint32_t op = m->words[at] & 0xffff, *w = &m->words[at];
    switch (op) {
    case OP_NAME: m->entry[w[1]].name = (const char *)&w[2]; break;
    case OP_MEMBER_NAME:
        if (w[2] < MEMBERS) {
            m->entry[w[1]].member[w[2]] = (const char *)&w[3];
        }
        break;
    case OP_MEMBER_DECORATE:
        if (w[2] < MEMBERS && w[3] == DECORATION_OFFSET) {
            m->entry[w[1]].offset_at[w[2]] = at + 4;
        }
        break;
    case OP_DECORATE: index_decoration(m, at); break;
    case OP_EXECUTION_MODE_ID:
        if (w[2] == MODE_LOCAL_SIZE_ID) {
            memcpy(m->local_size_id, &w[3], sizeof m->local_size_id);
        }
        break;
    case OP_CONSTANT:
        m->entry[w[2]].opcode = op;
        m->entry[w[2]].at = at;
        break;
    case OP_TYPE_RUNTIME_ARRAY:
    case OP_TYPE_ARRAY:
    case OP_TYPE_STRUCT:
    case OP_TYPE_POINTER:
        m->entry[w[1]].opcode = op;
        m->entry[w[1]].at = at;
        break;
    case OP_VARIABLE:
        m->entry[w[2]].opcode = op;
        m->entry[w[2]].at = at;
        break;
    default:
        if (is_float_arithmetic(op)) {
            m->entry[w[2]].opcode = op;
        }
        break;
    }
}

static void index_module(module *m)
{
    memset(m->entry, 0, m->bound * sizeof *m->entry);
    memset(m->local_size_id, 0, sizeof m->local_size_id);
    m->error[0] = '\0';
    for (uint32_t at = 5; at < m->count; at += m->words[at] >> 16) {
        index_instruction(m, at);
    }
}

static bool refuse(module *m, const char *what, const char *where, uint32_t found, uint32_t expected)
{
    snprintf(m->error, sizeof m->error, "%s of %s is %u, expected %u", what, where, found, expected);
    return false;
}

/* Offsets of a struct of sim_shared.h against offsetof, all members in both directions. */
static bool check_struct(module *m, uint32_t id)
{
    const entry *e = &m->entry[id];
    uint32_t known = 0;
    const uint32_t members = (m->words[e->at] >> 16) - 2;
    for (size_t f = 0; f < FIELD_COUNT; f++) {
        if (strcmp(fields[f].type, e->name) != 0) {
            continue;
        }
        if (known >= members || strcmp(e->member[known], fields[f].member) != 0) {
            return refuse(m, "member number", fields[f].member, known, known);
        }
        if (!e->offset_at[known] || m->words[e->offset_at[known]] != fields[f].offset) {
            return refuse(m, "offset", fields[f].member,
                          e->offset_at[known] ? m->words[e->offset_at[known]] : NONE, fields[f].offset);
        }
        known++;
    }
    return known == members ? true : refuse(m, "member count", e->name, members, known);
}

static bool check_block(module *m, uint32_t variable, uint32_t struct_id, uint32_t *seen)
{
    const entry *v = &m->entry[variable], *s = &m->entry[struct_id];
    const uint32_t array_id = m->words[s->at + 2];
    const entry *array = &m->entry[array_id], *element;
    size_t b = 0;
    while (b < BLOCK_COUNT && strcmp(blocks[b].name, s->name) != 0) {
        b++;
    }
    if (b == BLOCK_COUNT || (array->opcode != OP_TYPE_RUNTIME_ARRAY && array->opcode != OP_TYPE_ARRAY)) {
        return refuse(m, "known block", s->name, 0, 1);
    }
    if (!v->binding_at || m->words[v->binding_at] != blocks[b].binding) {
        return refuse(m, "binding", s->name, v->binding_at ? m->words[v->binding_at] : NONE,
                      blocks[b].binding);
    }
    if (!v->set_at || m->words[v->set_at] != 0) {
        return refuse(m, "set", s->name, v->set_at ? m->words[v->set_at] : NONE, 0);
    }
    if (!array->stride_at || m->words[array->stride_at] != blocks[b].stride) {
        return refuse(m, "stride", s->name, array->stride_at ? m->words[array->stride_at] : NONE,
                      blocks[b].stride);
    }
    if (!s->offset_at[0] || m->words[s->offset_at[0]] != 0) {
        return refuse(m, "offset of the array", s->name, NONE, 0);
    }
    *seen |= 1u << blocks[b].binding;
    element = &m->entry[m->words[array->at + 2]];
    return element->opcode == OP_TYPE_STRUCT ? check_struct(m, m->words[array->at + 2]) : true;
}

static bool check_texels(module *m, uint32_t variable, uint32_t *seen)
{
    const entry *v = &m->entry[variable];
    size_t t = 0;
    while (t < TEXEL_COUNT && strcmp(texels[t].name, v->name) != 0) {
        t++;
    }
    if (t == TEXEL_COUNT) {
        return refuse(m, "known texel buffer", v->name, 0, 1);
    }
    if (!v->binding_at || m->words[v->binding_at] != texels[t].binding) {
        return refuse(m, "binding", v->name, v->binding_at ? m->words[v->binding_at] : NONE,
                      texels[t].binding);
    }
    if (!v->set_at || m->words[v->set_at] != 0) {
        return refuse(m, "set", v->name, v->set_at ? m->words[v->set_at] : NONE, 0);
    }
    *seen |= 1u << texels[t].binding;
    return true;
}

/* Buffers, texel buffers and push constants of the module. */
static bool check_variables(module *m, uint32_t expected)
{
    uint32_t seen = 0, pushes = 0;
    for (uint32_t id = 0; id < m->bound; id++) {
        const entry *v = &m->entry[id];
        uint32_t storage, struct_id;
        if (v->opcode != OP_VARIABLE) {
            continue;
        }
        storage = m->words[v->at + 3];
        struct_id = m->words[m->entry[m->words[v->at + 1]].at + 3];
        if ((storage == STORAGE_BUFFER || storage == STORAGE_UNIFORM) &&
            !check_block(m, id, struct_id, &seen)) {
            return false;
        }
        if (storage == STORAGE_TEXELS && !check_texels(m, id, &seen)) {
            return false;
        }
        if (storage == STORAGE_PUSH_CONSTANT) {
            const entry *outer = &m->entry[struct_id];
            pushes++;
            if (!outer->offset_at[0] || m->words[outer->offset_at[0]] != 0) {
                return refuse(m, "offset", "the push constants", NONE, 0);
            }
            if (!check_struct(m, m->words[m->entry[struct_id].at + 2])) {
                return false;
            }
        }
    }
    if (pushes != 1) {
        return refuse(m, "number", "push constant blocks", pushes, 1);
    }
    return seen == expected ? true : refuse(m, "set of bindings", "the stage", seen, expected);
}

static bool check_contraction(module *m)
{
    for (uint32_t at = 5; at < m->count; at += m->words[at] >> 16) {
        const uint32_t op = m->words[at] & 0xffff;
        if (is_float_arithmetic(op) && !m->entry[m->words[at + 2]].contraction_at) {
            return refuse(m, "NoContraction", "a float operation", 0, 1);
        }
    }
    return true;
}

static bool check_module(module *m, uint32_t bindings)
{
    static const uint32_t size[3] = {RIS_GROUP_NODE, 1, 1};
    index_module(m);
    for (int k = 0; k < 3; k++) {
        const entry *constant = &m->entry[m->local_size_id[k]];
        if (constant->opcode != OP_CONSTANT || m->words[constant->at + 3] != size[k]) {
            return refuse(m, "group size", "an axis",
                          constant->opcode == OP_CONSTANT ? m->words[constant->at + 3] : NONE, size[k]);
        }
    }
    return check_variables(m, bindings) && check_contraction(m);
}

static void shaders_agree_with_c(void **state)
{
    (void)state;
    for (size_t s = 0; s < STAGE_COUNT; s++) {
        module m;
        read_module(stages[s].name, &m);
        if (!check_module(&m, stages[s].bindings)) {
            fail_msg("%s: %s", stages[s].name, m.error);
        }
        free_module(&m);
    }
}

/* Changes one word, which check_module must refuse, and puts it back. */
static void spoil(module *m, uint32_t bindings, uint32_t at, uint32_t value, const char *what)
{
    const uint32_t good = m->words[at];
    m->words[at] = value;
    if (check_module(m, bindings)) {
        fail_msg("a wrong %s at word %u went unnoticed", what, at);
    }
    m->words[at] = good;
    assert_true(check_module(m, bindings));
}

static void every_spoiled_word_is_found(void **state)
{
    uint32_t spoiled = 0;
    (void)state;
    for (size_t s = 0; s < STAGE_COUNT; s++) {
        module m;
        read_module(stages[s].name, &m);
        assert_true(check_module(&m, stages[s].bindings));
        spoil(&m, stages[s].bindings, m.entry[m.local_size_id[0]].at + 3, 32, "group size");
        for (uint32_t at = 5; at < m.count; at += m.words[at] >> 16) {
            const uint32_t op = m.words[at] & 0xffff;
            const uint32_t decoration = op == OP_DECORATE ? m.words[at + 2] : NONE;
            if (op == OP_DECORATE && (decoration == DECORATION_BINDING || decoration == DECORATION_SET)) {
                spoil(&m, stages[s].bindings, at + 3, m.words[at + 3] + 1, "binding or set");
                spoiled++;
            }
            if (op == OP_DECORATE && decoration == DECORATION_ARRAY_STRIDE) {
                spoil(&m, stages[s].bindings, at + 3, m.words[at + 3] + 4, "stride");
                spoiled++;
            }
            if (op == OP_DECORATE && decoration == DECORATION_NO_CONTRACTION &&
                is_float_arithmetic(m.entry[m.words[at + 1]].opcode)) { /* glslang marks indices, too */
                spoil(&m, stages[s].bindings, at + 2, 0, "precise");
                spoiled++;
            }
            if (op == OP_MEMBER_DECORATE && m.words[at + 3] == DECORATION_OFFSET) {
                spoil(&m, stages[s].bindings, at + 4, m.words[at + 4] + 4, "offset");
                spoiled++;
            }
        }
        free_module(&m);
    }
    assert_true(spoiled > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shaders_agree_with_c),
        cmocka_unit_test(every_spoiled_word_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
