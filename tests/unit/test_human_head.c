/* The committed reference head: counts, exact mirror symmetry, Frankfort pose, regions, depth, jaw weight, and every
 * part in its place (KA-01, KA-03, KA-06, KA-09). */
#include "risorius/head.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static ris_head head;
static uint32_t *mirror; /* skin vertex at (-x, y, z) */

static ris_vec3 minus(ris_vec3 a, ris_vec3 b)
{
    return (ris_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static float dot(ris_vec3 a, ris_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static ris_vec3 cross(ris_vec3 a, ris_vec3 b)
{
    return (ris_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static uint32_t mirror_of(const ris_mesh *mesh, ris_vec3 p)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        if (mesh->position[i].x == -p.x && mesh->position[i].y == p.y && mesh->position[i].z == p.z)
            return i;
    return UINT32_MAX;
}

/* Skin vertex that came from a base mesh vertex. */
static uint32_t from_base(int32_t base)
{
    for (uint32_t i = 0; i < head.skin.vertex_count; i++)
        if (head.base_vertex[i] == base)
            return i;
    fail_msg("base vertex %d is not on the head", base);
    return 0;
}

static bool has(const ris_region *region, uint32_t vertex)
{
    assert_non_null(region);
    for (uint32_t i = 0; i < region->count; i++)
        if (region->vertex[i] == vertex)
            return true;
    return false;
}

static const ris_part_def *part(const char *name)
{
    for (uint32_t i = 0; i < head.part_count; i++)
        if (strcmp(head.part[i].name, name) == 0)
            return &head.part[i];
    fail_msg("no part \"%s\"", name);
    return NULL;
}

static int load(void **state)
{
    ris_error err = {0};
    (void)state;
    if (ris_head_load(RIS_SOURCE_DIR "/assets/human", &head, &err) != RIS_OK) {
        print_error("%s\n", err.text);
        return -1;
    }
    mirror = malloc(head.skin.vertex_count * sizeof *mirror);
    for (uint32_t i = 0; mirror && i < head.skin.vertex_count; i++)
        mirror[i] = mirror_of(&head.skin, head.skin.position[i]);
    return mirror ? 0 : -1;
}

static int drop(void **state)
{
    (void)state;
    free(mirror);
    ris_head_finish(&head);
    return 0;
}

static void test_counts(void **state)
{
    (void)state;
    assert_int_equal(head.skin.vertex_count, 4368);
    assert_int_equal(head.skin.face_count, 4346);
    assert_int_equal(head.skin.uv_count, 4561);
    for (uint32_t f = 0; f < head.skin.face_count; f++)
        assert_int_equal(head.skin.face_start[f + 1] - head.skin.face_start[f], 4);
    assert_string_equal(head.simulated, "face");
    assert_true(ris_head_region(&head, "face")->count >= 2000);
    for (uint32_t i = 1; i < head.skin.vertex_count; i++)
        assert_true(head.base_vertex[i] > head.base_vertex[i - 1]);
    assert_in_range(head.base_vertex[head.skin.vertex_count - 1], 4368, 13379);
}

/* One open border, the ring of the neck: 42 edges that one face has. */
static void test_border(void **state)
{
    (void)state;
    const ris_mesh *m = &head.skin;
    uint32_t border = 0;
    for (uint32_t a = 0; a < m->face_start[m->face_count]; a++) {
        uint32_t v = m->face_vertex[a], w = m->face_vertex[a - a % 4 + (a + 1) % 4];
        bool paired = false;
        for (uint32_t b = 0; b < m->face_start[m->face_count] && !paired; b++)
            paired = m->face_vertex[b] == w && m->face_vertex[b - b % 4 + (b + 1) % 4] == v;
        border += !paired;
    }
    assert_int_equal(border, 42);
    ris_error err = {0};
    assert_int_equal(ris_mesh_check(m, "skin", &err), RIS_OK);
}

static void test_mirror(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < head.skin.vertex_count; i++) {
        uint32_t k = mirror[i];
        assert_int_not_equal(k, UINT32_MAX);
        assert_true(head.depth_mm[i] == head.depth_mm[k]);
        assert_true(head.jaw_weight[i] == head.jaw_weight[k]);
    }
    ris_vec3 moved = head.skin.position[100]; /* negative control */
    moved.y += 1e-4f;
    assert_int_equal(mirror_of(&head.skin, moved), UINT32_MAX);
}

/* Splitting each quad along its first diagonal is mirror-symmetric too. */
static void test_mirrored_diagonals(void **state)
{
    (void)state;
    const ris_mesh *m = &head.skin;
    for (uint32_t f = 0; f < m->face_count; f++) {
        uint32_t a = mirror[m->face_vertex[4 * f]], c = mirror[m->face_vertex[4 * f + 2]];
        bool found = false;
        for (uint32_t g = 0; g < m->face_count && !found; g++) {
            uint32_t p = m->face_vertex[4 * g], q = m->face_vertex[4 * g + 2];
            found = (p == a && q == c) || (p == c && q == a);
        }
        assert_true(found);
    }
}

/* Porions level with orbitales, origin between the porions (within the rounding of the file). */
static void test_frankfort(void **state)
{
    (void)state;
    ris_vec3 porion = head.skin.position[from_base(12210)], orbitale = head.skin.position[from_base(11829)];
    assert_float_equal(porion.y, 0, 2e-6);
    assert_float_equal(porion.z, 0, 2e-6);
    assert_float_equal(orbitale.y, 0, 2e-6);
    assert_true(porion.x > 50 && orbitale.x > 20 && orbitale.z > 60);
    ris_vec3 nose = head.skin.position[from_base(5054)];
    assert_true(nose.z > orbitale.z && nose.x == 0);
}

static void test_regions_mirror(void **state)
{
    (void)state;
    for (uint32_t r = 0; r < head.region_count; r++) {
        char name[RIS_NAME_SIZE];
        snprintf(name, sizeof name, "%s", head.region[r].name);
        size_t length = strlen(name);
        if (length > 2 && name[length - 2] == '.')
            name[length - 1] = name[length - 1] == 'L' ? 'R' : 'L';
        const ris_region *other = ris_head_region(&head, name);
        assert_non_null(other);
        assert_int_equal(other->count, head.region[r].count);
        for (uint32_t i = 0; i < head.region[r].count; i++)
            assert_true(has(other, mirror[head.region[r].vertex[i]]));
    }
}

static void test_regions(void **state)
{
    (void)state;
    static const char *const in_face[] = {"lips", "inner_lip_rim", "mouth_cavity", "lids",
                                          "nose", "cheek",         "chin",         "forehead"};
    static const char *const outside[] = {"scalp", "ear"};
    const ris_region *face = ris_head_region(&head, "face"), *lips = ris_head_region(&head, "lips");
    const ris_region *upper = ris_head_region(&head, "lip_upper"),
                     *lower = ris_head_region(&head, "lip_lower");
    for (size_t k = 0; k < sizeof in_face / sizeof *in_face; k++) {
        const ris_region *region = ris_head_region(&head, in_face[k]);
        assert_non_null(region);
        uint32_t inside = 0;
        for (uint32_t i = 0; i < region->count; i++)
            inside += has(face, region->vertex[i]);
        assert_true(inside >= 0.95 * region->count);
    }
    for (size_t k = 0; k < sizeof outside / sizeof *outside; k++)
        for (uint32_t i = 0; i < ris_head_region(&head, outside[k])->count; i++)
            assert_false(has(face, ris_head_region(&head, outside[k])->vertex[i]));
    for (uint32_t i = 0; i < lips->count; i++)
        assert_true(has(upper, lips->vertex[i]) || has(lower, lips->vertex[i]));
    for (uint32_t i = 0; i < upper->count; i++) /* only the corners belong to both */
        assert_true(!has(lower, upper->vertex[i]) || fabsf(head.skin.position[upper->vertex[i]].x) > 20);
}

/* Within 1.2 mm of the slit the normal tells the lips apart: the upper one looks down, the lower one up. */
static void test_lips_by_normal(void **state)
{
    (void)state;
    const ris_mesh *m = &head.skin;
    const ris_region *upper = ris_head_region(&head, "lip_upper"), *lips = ris_head_region(&head, "lips");
    float slit = (m->position[from_base(474)].y + m->position[from_base(493)].y) / 2;
    float *up = calloc(m->vertex_count, sizeof *up);
    assert_non_null(up);
    for (uint32_t f = 0; f < m->face_count; f++) {
        const uint32_t *q = &m->face_vertex[4 * f];
        ris_vec3 n =
            cross(minus(m->position[q[2]], m->position[q[0]]), minus(m->position[q[3]], m->position[q[1]]));
        for (int k = 0; k < 4; k++)
            up[q[k]] += n.y;
    }
    uint32_t looked_at = 0;
    for (uint32_t i = 0; i < lips->count; i++) {
        uint32_t v = lips->vertex[i];
        if (fabsf(m->position[v].y - slit) < 1.2f && fabsf(m->position[v].x) < 22) {
            assert_true(has(upper, v) == (up[v] < 0));
            looked_at++;
        }
    }
    free(up);
    assert_true(looked_at > 40);
}

static void test_fields(void **state)
{
    (void)state;
    const ris_region *lids = ris_head_region(&head, "lids"), *chin = ris_head_region(&head, "chin");
    const ris_region *forehead = ris_head_region(&head, "forehead"),
                     *upper = ris_head_region(&head, "lip_upper");
    for (uint32_t i = 0; i < head.skin.vertex_count; i++) {
        assert_true(head.depth_mm[i] >= 2 && head.depth_mm[i] <= 18);
        assert_true(head.jaw_weight[i] >= 0 && head.jaw_weight[i] <= 1);
    }
    for (uint32_t i = 0; i < lids->count; i++)
        assert_true(head.depth_mm[lids->vertex[i]] < 8 && head.jaw_weight[lids->vertex[i]] < 0.01f);
    for (uint32_t i = 0; i < chin->count; i++)
        assert_true(head.jaw_weight[chin->vertex[i]] > 0.5f);
    for (uint32_t i = 0; i < forehead->count; i++)
        assert_true(head.jaw_weight[forehead->vertex[i]] == 0);
    for (uint32_t i = 0; i < upper->count; i++)
        if (fabsf(head.skin.position[upper->vertex[i]].x) < 10)
            assert_true(head.jaw_weight[upper->vertex[i]] < 0.05f);
    assert_true(head.jaw_weight[from_base(493)] > 0.98f);
    assert_float_equal(head.jaw_weight[from_base(10400)], 0.44, 0.05);
    assert_float_equal(head.depth_mm[from_base(5342)], 10, 1.5); /* mid-philtrum */
}

/* Solid angle of the skin without the lining of the mouth, over the full sphere: about 1 inside, 0 outside. */
static double winding(const ris_region *lining, ris_vec3 p)
{
    const ris_mesh *m = &head.skin;
    double sum = 0;
    for (uint32_t f = 0; f < m->face_count; f++)
        for (uint32_t k = 1; k < 3; k++) {
            const uint32_t *q = &m->face_vertex[4 * f];
            if (lining->count && has(lining, q[0]))
                continue;
            ris_vec3 a = minus(m->position[q[0]], p), b = minus(m->position[q[k]], p),
                     c = minus(m->position[q[k + 1]], p);
            double la = sqrt(dot(a, a)), lb = sqrt(dot(b, b)), lc = sqrt(dot(c, c));
            sum +=
                atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
        }
    return sum / 6.283185307179586;
}

static void test_mouth_parts_inside(void **state)
{
    (void)state;
    static const char *const names[] = {"teeth_upper", "teeth_lower", "gum_upper", "gum_lower", "tongue"};
    const ris_region *lining = ris_head_region(&head, "mouth_cavity");
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        const ris_mesh *m = &part(names[k])->mesh;
        for (uint32_t i = 0; i < m->vertex_count; i += 41)
            assert_true(winding(lining, m->position[i]) > 0.5);
    }
    ris_vec3 front = head.skin.position[from_base(466)]; /* negative control: in front of the lip */
    front.z += 5;
    assert_true(winding(lining, front) < 0.5);
}

static void test_mouth_parts_placed(void **state)
{
    (void)state;
    float slit = head.skin.position[from_base(474)].y, lip = head.skin.position[from_base(509)].z;
    const ris_mesh *upper = &part("teeth_upper")->mesh, *lower = &part("teeth_lower")->mesh;
    float upper_edge = 1e9f, lower_edge = -1e9f;
    for (uint32_t i = 0; i < upper->vertex_count; i++) {
        upper_edge = fminf(upper_edge, upper->position[i].y);
        assert_true(upper->position[i].z < lip - 5);
    }
    for (uint32_t i = 0; i < lower->vertex_count; i++) {
        assert_true(lower->position[i].z < lip - 5);
        if (fabsf(lower->position[i].x) < 10)
            lower_edge = fmaxf(lower_edge, lower->position[i].y);
    }
    assert_true(fabsf(upper_edge - slit) < 4 && fabsf(lower_edge - slit) < 4);
    assert_int_equal(part("teeth_lower")->bone, RIS_BONE_JAW);
    assert_int_equal(part("tongue")->bone, RIS_BONE_JAW);
    assert_int_equal(part("teeth_upper")->bone, RIS_BONE_SKULL);
}

/* Six times the volume: positive when all faces look outwards. */
static double volume6(const ris_mesh *m)
{
    double sum = 0;
    for (uint32_t f = 0; f < m->face_count; f++) {
        uint32_t first = m->face_start[f];
        for (uint32_t k = first + 1; k + 1 < m->face_start[f + 1]; k++) {
            ris_vec3 a = m->position[m->face_vertex[first]];
            sum += dot(a, cross(m->position[m->face_vertex[k]], m->position[m->face_vertex[k + 1]]));
        }
    }
    return sum;
}

static uint32_t open_edges(const ris_mesh *m)
{
    uint32_t *used = calloc((size_t)m->vertex_count * 64, sizeof *used),
             open = 0; /* vertices reached from each */
    assert_non_null(used);
    for (uint32_t f = 0; f < m->face_count; f++)
        for (uint32_t k = m->face_start[f]; k < m->face_start[f + 1]; k++) {
            uint32_t next = k + 1 < m->face_start[f + 1] ? k + 1 : m->face_start[f];
            uint32_t *row = &used[(size_t)m->face_vertex[k] * 64];
            assert_true(row[0] < 63);
            row[++row[0]] = m->face_vertex[next];
        }
    for (uint32_t v = 0; v < m->vertex_count; v++)
        for (uint32_t k = 1; k <= used[(size_t)v * 64]; k++) {
            const uint32_t *row = &used[(size_t)used[(size_t)v * 64 + k] * 64];
            bool back = false;
            for (uint32_t j = 1; j <= row[0]; j++)
                back |= row[j] == v;
            open += !back;
        }
    free(used);
    return open;
}

/* Teeth, gums and tongue are closed solids that look outwards; an eyeball is open at its back (negative control). */
static void test_mouth_parts_solid(void **state)
{
    (void)state;
    static const char *const names[] = {"teeth_upper", "teeth_lower", "gum_upper", "gum_lower", "tongue"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        assert_int_equal(open_edges(&part(names[k])->mesh), 0);
        assert_true(volume6(&part(names[k])->mesh) > 6 * 1000);
    }
    assert_int_not_equal(open_edges(&part("eye.L")->mesh), 0);
}

static float distance(ris_vec3 a, ris_vec3 b)
{
    return sqrtf(dot(minus(a, b), minus(a, b)));
}

static void test_eyes(void **state)
{
    (void)state;
    static const char *const sides[] = {"L", "R"};
    for (int s = 0; s < 2; s++) {
        char name[RIS_NAME_SIZE];
        snprintf(name, sizeof name, "eye.%s", sides[s]);
        const ris_part_def *eye = part(name);
        snprintf(name, sizeof name, "cornea.%s", sides[s]);
        const ris_part_def *cornea = part(name);
        float radius = 0, apex = 0;
        for (uint32_t i = 0; i < eye->mesh.vertex_count; i++)
            radius = fmaxf(radius, distance(eye->mesh.position[i], eye->pivot));
        for (uint32_t i = 0; i < cornea->mesh.vertex_count; i++) {
            apex = fmaxf(apex, distance(cornea->mesh.position[i], cornea->pivot));
            assert_true(cornea->mesh.position[i].z > eye->pivot.z);
        }
        assert_float_equal(radius, 14.95, 0.01);
        assert_true(apex > radius + 1 && apex < radius + 1.8);
        assert_true((eye->pivot.x > 0) == (s == 0));
        assert_int_equal(eye->bone, s ? RIS_BONE_EYE_R : RIS_BONE_EYE_L);
    }
}

/* Height of a triangle over x, y, or NAN beside it. */
static float height_at(ris_vec3 a, ris_vec3 b, ris_vec3 c, float x, float y)
{
    float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    float u = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
    float v = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
    if (!(u >= 0 && v >= 0 && u + v <= 1))
        return NAN;
    return a.z + u * (b.z - a.z) + v * (c.z - a.z);
}

/* Number of places where a mesh moved by dz lies in front of the outer surface of the left lids. */
static uint32_t pokes(const ris_part_def *ball, float dz, uint32_t *covered)
{
    const ris_mesh *m = &head.skin;
    const ris_region *lids = ris_head_region(&head, "lids");
    uint32_t count = 0;
    for (uint32_t f = 0; f < m->face_count; f++) {
        const uint32_t *q = &m->face_vertex[4 * f];
        bool outer = true; /* all four on the lids and in front of the margin that touches the eye */
        for (int k = 0; k < 4; k++)
            outer &= distance(m->position[q[k]], ball->pivot) > 16.2f && has(lids, q[k]);
        ris_vec3 n =
            cross(minus(m->position[q[2]], m->position[q[0]]), minus(m->position[q[3]], m->position[q[1]]));
        for (uint32_t i = 0; outer && n.z > 0 && i < ball->mesh.vertex_count; i++) {
            ris_vec3 p = ball->mesh.position[i];
            for (int k = 1; k < 3; k++) {
                float z = height_at(m->position[q[0]], m->position[q[k]], m->position[q[k + 1]], p.x, p.y);
                *covered += !isnan(z);
                count += !isnan(z) && p.z + dz > z;
            }
        }
    }
    return count;
}

static void test_eyes_behind_lids(void **state)
{
    (void)state;
    static const char *const names[] = {"eye.L", "cornea.L", "eye.R", "cornea.R"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        uint32_t covered = 0;
        assert_int_equal(pokes(part(names[k]), 0, &covered), 0);
        assert_true(covered > 10);
        assert_true(pokes(part(names[k]), 3, &covered) > 0); /* negative control */
    }
}

static void test_parts_mirror(void **state)
{
    (void)state;
    static const char *const names[] = {"eye", "cornea", "brows", "lashes"};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        char name[RIS_NAME_SIZE];
        snprintf(name, sizeof name, "%s.L", names[k]);
        const ris_mesh *l = &part(name)->mesh;
        snprintf(name, sizeof name, "%s.R", names[k]);
        const ris_mesh *r = &part(name)->mesh;
        assert_int_equal(l->vertex_count, r->vertex_count);
        for (uint32_t i = 0; i < l->vertex_count; i++) {
            assert_true(l->position[i].x == -r->position[i].x && l->position[i].y == r->position[i].y);
            assert_true(l->position[i].z == r->position[i].z);
        }
    }
}

/* Hairs stay near the skin: no vertex farther from the nearest skin vertex than the limit. */
static void test_hair(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        float limit_mm;
    } hairs[] = {{"brows.L", 7}, {"lashes.L", 12}};
    for (size_t k = 0; k < 2; k++) {
        const ris_part_def *hair = part(hairs[k].name);
        assert_int_equal(hair->bone, RIS_BONE_SKIN);
        assert_int_equal(hair->material, RIS_MATERIAL_HAIR);
        assert_true(hair->mesh.vertex_count > 500);
        for (uint32_t i = 0; i < hair->mesh.vertex_count; i += 7) {
            float nearest = 1e9f;
            for (uint32_t v = 0; v < head.skin.vertex_count; v++)
                nearest = fminf(nearest, distance(head.skin.position[v], hair->mesh.position[i]));
            assert_true(nearest < hairs[k].limit_mm);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_counts),
        cmocka_unit_test(test_border),
        cmocka_unit_test(test_mirror),
        cmocka_unit_test(test_mirrored_diagonals),
        cmocka_unit_test(test_frankfort),
        cmocka_unit_test(test_regions_mirror),
        cmocka_unit_test(test_regions),
        cmocka_unit_test(test_lips_by_normal),
        cmocka_unit_test(test_fields),
        cmocka_unit_test(test_mouth_parts_inside),
        cmocka_unit_test(test_mouth_parts_placed),
        cmocka_unit_test(test_mouth_parts_solid),
        cmocka_unit_test(test_eyes),
        cmocka_unit_test(test_eyes_behind_lids),
        cmocka_unit_test(test_parts_mirror),
        cmocka_unit_test(test_hair),
    };
    return cmocka_run_group_tests(tests, load, drop);
}
