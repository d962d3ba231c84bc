/* ris_head_load: a small head, and every way in which its files can be wrong. */
#include "scratch.h"

#include "risorius/head.h"

#include <math.h>

#define SKIN "v -1 0 0\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 1 0\nvt 0 0\nf 1 2 5 6\nf 2 3 4 5\n"
#define DEPTH "vertex,depth_mm,jaw_weight\n0,5,0\n1,5.5,0.25\n2,5,0\n3,4,0.5\n4,4,1\n5,4,0.5\n"
#define REGIONS "{\"face\":[[0,3],[2,5]],\"lips\":[[1,1],[4,4]]}"
#define GRID "[[[10,0,0],[10,1,0]],[[12,0,0],[12,1,1]],[[14,0,0],[14,1,1]]]"
#define MUSCLE_L                                                                                             \
    "{\"name\":\"risorius.L\",\"kind\":\"linear\",\"grid\":" GRID ",\"au\":[\"AU20\"],\"origin\":"           \
    "\"fascia\"}"
#define MUSCLES_HEAD "{\"format\":\"risorius-muscles\",\"version\":1,\"muscles\":["
#define MUSCLES MUSCLES_HEAD "{\"name\":\"risorius.R\",\"mirror_of\":\"risorius.L\"},\n" MUSCLE_L "]}"
#define EXPRESSIONS_HEAD "{\"format\":\"risorius-expressions\",\"version\":1,\"expressions\":"
#define EXPRESSIONS                                                                                          \
    EXPRESSIONS_HEAD "{\"smile\":{\"risorius\":0.8,\"jaw.open\":0.1},\"grin\":{\"smile\":0.5,\"eye.yaw.L\":" \
                     "3},\"neutral\":{}}}"
#define HEAD_START                                                                                           \
    "{\"format\":\"risorius-head\",\"version\":1,\"units\":\"mm\",\"skin\":\"skin.obj\",\"regions\":"        \
    "\"regions.json\","                                                                                      \
    "\"simulated\":\"face\",\"depth\":\"depth.csv\",\"muscles\":\"muscles.json\""
#define JAW ",\"jaw\":{\"point\":[0,1,2],\"axis\":[2,0,0]}"
#define MORE                                                                                                 \
    ",\"map\":\"skin.map\",\"color\":\"skin.png\",\"expressions\":\"expressions.json\","                     \
    "\"parts\":[{\"name\":\"eye.L\",\"mesh\":\"eye.obj\",\"bone\":\"eye.L\",\"pivot\":[3,2,1],\"material\":" \
    "\"eye\",\"tint\":[1,0,0.5]},"                                                                           \
    "{\"name\":\"teeth_lower\",\"mesh\":\"eye.obj\",\"bone\":\"jaw\",\"material\":\"teeth\",\"color\":"      \
    "\"skin.png\"}]"

/* A sound head in the scratch folder. */
static void write_head(void)
{
    scratch_write("skin.obj", SKIN);
    scratch_write("eye.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    scratch_write("skin.map", "3\n-1\n5\n7\n9\n11\n");
    scratch_write("skin.png", "not looked into here");
    scratch_write("depth.csv", DEPTH);
    scratch_write("regions.json", REGIONS);
    scratch_write("muscles.json", MUSCLES);
    scratch_write("expressions.json", EXPRESSIONS);
    scratch_write("head.json", HEAD_START JAW MORE "}");
}

static void expect_loads(ris_head *head)
{
    ris_error err = {0};
    ris_result result = ris_head_load(scratch_folder, head, &err);
    if (result != RIS_OK) {
        print_error("%s\n", err.text);
    }
    assert_int_equal(result, RIS_OK);
}

/* With this text in this file the head is refused with this sentence, and nothing is left half-loaded. */
static void expect_refused(const char *file, const char *text, const char *says)
{
    static const ris_head empty;
    ris_head head;
    ris_error err = {0};
    write_head();
    scratch_write(file, text);
    expect_error(&err, ris_head_load(scratch_folder, &head, &err), RIS_ERROR_DATA, says);
    assert_memory_equal(&head, &empty, sizeof head);
    write_head();
}

static void test_loads(void **state)
{
    (void)state;
    ris_head head;
    write_head();
    expect_loads(&head);
    assert_string_equal(head.directory, scratch_folder);
    assert_int_equal(head.skin.vertex_count, 6);
    assert_int_equal(head.base_vertex[1], -1);
    assert_int_equal(head.base_vertex[5], 11);
    assert_string_equal(head.color, scratch_path("skin.png"));
    assert_string_equal(head.simulated, "face");
    assert_int_equal(head.region_count, 2);
    assert_int_equal(ris_head_region(&head, "face")->count, 6); /* overlapping ranges count once */
    const ris_region *lips = ris_head_region(&head, "lips");
    assert_int_equal(lips->count, 2);
    assert_int_equal(lips->vertex[0], 1);
    assert_int_equal(lips->vertex[1], 4);
    assert_null(ris_head_region(&head, "nose"));
    assert_true(head.depth_mm[1] == 5.5f && head.jaw_weight[1] == 0.25f && head.jaw_weight[4] == 1);
    assert_true(head.jaw.axis.x == 1 && head.jaw.point.z == 2 && head.jaw.open_deg == 20 &&
                head.jaw.side_mm == 6);
    assert_int_equal(head.part_count, 2);
    assert_int_equal(head.part[0].bone, RIS_BONE_EYE_L);
    assert_int_equal(head.part[0].material, RIS_MATERIAL_EYE);
    assert_true(head.part[0].pivot.x == 3 && head.part[0].tint.z == 0.5f);
    assert_null(head.part[0].color);
    assert_int_equal(head.part[1].bone, RIS_BONE_JAW);
    assert_string_equal(head.part[1].color, scratch_path("skin.png"));
    assert_int_equal(head.expression_count, 3);
    assert_string_equal(head.expression[0].name, "smile");
    assert_int_equal(head.expression[0].term_count, 2);
    assert_string_equal(head.expression[0].term[0].channel, "risorius");
    assert_true(head.expression[0].term[0].value == 0.8f);
    assert_int_equal(head.expression[2].term_count, 0);
    ris_head_finish(&head);
    ris_head_finish(&head);
}

static void test_mirrored_muscle(void **state)
{
    (void)state;
    ris_head head;
    write_head();
    expect_loads(&head);
    assert_int_equal(head.muscle_count, 2);
    const ris_muscle_def *r = &head.muscle[0],
                         *l = &head.muscle[1]; /* the order of the file, mirrored or not */
    assert_string_equal(r->name, "risorius.R");
    assert_string_equal(l->name, "risorius.L");
    assert_int_equal(r->rows, 3);
    assert_int_equal(r->columns, 2);
    for (uint32_t row = 0; row < 3; row++) {
        for (uint32_t c = 0; c < 2; c++) {
            const ris_vec3 *a = &l->grid[row * 2 + c], *b = &r->grid[row * 2 + (1 - c)];
            assert_true(a->x == -b->x && a->y == b->y && a->z == b->z);
        }
    }
    assert_true(l->grid[2].x == 12);
    assert_true(l->radius_mm == 8 && l->insertion_start == 0.5f && l->lip_drag_power == 0 && l->gain == 1.2f);
    assert_true(r->max_shortening == 0.15f && r->thickness_mm[0] == 2 && r->thickness_mm[1] == 6);
    assert_true(r->attach_auto);
    assert_int_equal(r->bone, RIS_BONE_AUTO);
    assert_int_equal(r->au_count, 1);
    assert_string_equal(r->au[0], "AU20");
    assert_string_equal(r->origin, "fascia");
    assert_string_equal(r->insertion, "");
    assert_ptr_not_equal(r->grid, l->grid);
    ris_head_finish(&head);
}

static void test_muscle_keys(void **state)
{
    (void)state;
    ris_head head;
    write_head();
    scratch_write(
        "muscles.json", MUSCLES_HEAD
        "{\"name\":\"orbicularis_oris_inferior\",\"mirror_of\":null,\"kind\":\"sphincter\",\"bone\":\"jaw\","
        "\"grid\":" GRID
        ",\"axis\":[[0,0,10],[0,0,20]],\"thickness_mm\":[1,3],\"max_shortening\":0.3,\"attach\":[1,4],"
        "\"radius_mm\":5,\"insertion_start\":0.25,\"lip_drag_power\":6,\"gain\":1,\"source\":\"a book\"}]}");
    scratch_write("head.json", HEAD_START JAW "}");
    expect_loads(&head);
    const ris_muscle_def *m = &head.muscle[0];
    assert_int_equal(m->kind, RIS_MUSCLE_SPHINCTER);
    assert_int_equal(m->bone, RIS_BONE_JAW);
    assert_true(m->has_axis && m->axis[1].z == 20);
    assert_true(m->thickness_mm[0] == 1 && m->max_shortening == 0.3f && m->radius_mm == 5 &&
                m->insertion_start == 0.25f);
    assert_true(m->lip_drag_power == 6 && m->gain == 1);
    assert_false(m->attach_auto);
    assert_int_equal(m->attach_count, 2);
    assert_int_equal(m->attach[1], 4);
    assert_string_equal(m->source, "a book");
    ris_head_finish(&head);
    scratch_write("muscles.json",
                  MUSCLES_HEAD "{\"name\":\"a.L\",\"kind\":\"linear\",\"grid\":" GRID
                               ",\"acts_on\":\"lid\"},{\"name\":\"a.R\",\"mirror_of\":\"a.L\"}]}");
    expect_loads(&head);
    assert_int_equal(head.muscle[0].acts_on, RIS_ACTS_ON_LID);
    assert_int_equal(head.muscle[1].acts_on, RIS_ACTS_ON_LID);
    assert_true(head.muscle[0].bowstring == 0 && head.muscle[0].push_lip[0] == 0);
    ris_head_finish(&head);
    scratch_write("muscles.json", MUSCLES_HEAD "{\"name\":\"a.L\",\"kind\":\"linear\",\"grid\":" GRID
                                               ",\"bowstring\":0.5,\"push_lip\":[1.5,-0.25]},"
                                               "{\"name\":\"a.R\",\"mirror_of\":\"a.L\"}]}");
    expect_loads(&head);
    for (uint32_t k = 0; k < 2; k++) {
        assert_true(head.muscle[k].bowstring == 0.5f);
        assert_true(head.muscle[k].push_lip[0] == 1.5f && head.muscle[k].push_lip[1] == -0.25f);
    }
    ris_head_finish(&head);
}

/* A muscle between bones that drives the jaw; its mirror image drives it to the other side. */
static void test_jaw_muscle_keys(void **state)
{
    (void)state;
#define CHEWING(more) MUSCLES_HEAD "{\"name\":\"masseter.L\",\"kind\":\"linear\",\"grid\":" GRID more "}]}"
#define BOTH ",\"bone\":\"skull\",\"end_bone\":\"jaw\",\"drives\":{\"open\":-0.5,\"side\":0.25}"
    ris_head head;
    write_head();
    scratch_write("muscles.json",
                  MUSCLES_HEAD "{\"name\":\"masseter.L\",\"kind\":\"linear\",\"grid\":" GRID BOTH
                               "},{\"name\":\"masseter.R\",\"mirror_of\":\"masseter.L\"}]}");
    scratch_write("head.json", HEAD_START JAW "}");
    expect_loads(&head);
    for (uint32_t k = 0; k < 2; k++) {
        assert_int_equal(head.muscle[k].end_bone, RIS_BONE_JAW);
        assert_true(head.muscle[k].drives[0] == -0.5f && head.muscle[k].drives[1] == 0);
        assert_true(head.muscle[k].drives[2] == (k ? -0.25f : 0.25f));
    }
    ris_head_finish(&head);
    expect_refused("muscles.json", CHEWING(",\"end_bone\":\"jaw\""),
                   "muscles[0].end_bone: expected no end_bone but");
    expect_refused("muscles.json", CHEWING(",\"bone\":\"skull\",\"end_bone\":\"hyoid\""),
                   "muscles[0].end_bone: expected");
    expect_refused("muscles.json", CHEWING(",\"drives\":{\"open\":2}"),
                   "muscles[0].drives.open: expected a number of -1 to 1, found 2");
    expect_refused("muscles.json", CHEWING(",\"drives\":{\"shut\":1}"),
                   "muscles[0].drives.shut: unknown key");
    expect_refused("muscles.json", CHEWING(",\"drives\":1"), "muscles[0].drives: expected an object");
}

static void test_tissue(void **state)
{
    (void)state;
    ris_head head;
    write_head();
    expect_loads(&head);
    /* the default, less the regions that this head has not */
    assert_int_equal(head.tissue.model, RIS_TISSUE_RISORIUS);
    assert_true(head.tissue.continuous && head.tissue.stiffness_scale == 2 && head.tissue.substeps == 8);
    assert_int_equal(head.tissue.anchor_region_count, 4);
    assert_string_equal(head.tissue.anchor_region[1].region, "lips");
    assert_string_equal(head.tissue.anchor_region[2].region, "muscle");
    assert_string_equal(head.tissue.anchor_region[3].region, "lips");
    ris_head_finish(&head);
    scratch_write("head.json",
                  HEAD_START JAW ",\"tissue\":{\"model\":\"kaehler\",\"law\":\"jump\",\"modulus\":[50,500],"
                                 "\"switch\":1.4,\"mass_g\":0.1,\"substeps\":12,"
                                 "\"anchors\":[{\"region\":\"bone\",\"normal\":10,\"tangential\":5},{"
                                 "\"region\":\"lips\",\"normal\":1,\"tangential\":2}]}}");
    expect_loads(&head);
    assert_int_equal(head.tissue.model, RIS_TISSUE_KAEHLER);
    assert_false(head.tissue.continuous);
    assert_true(head.tissue.modulus[1] == 500 && head.tissue.switch_stretch == 1.4f &&
                head.tissue.mass_g == 0.1f);
    assert_true(head.tissue.bending == 100 && head.tissue.compression == 0.2f);
    assert_int_equal(head.tissue.substeps, 12);
    assert_int_equal(head.tissue.anchor_region_count, 2);
    assert_true(head.tissue.anchor_region[1].tangential == 2);
    ris_head_finish(&head);
}

/* A muscle takes its own onset and release, else those of its sort; a mirrored one those of its source. */
static void test_dynamics(void **state)
{
    (void)state;
    ris_head head;
    write_head();
    expect_loads(&head);
    const ris_dynamics_def def = ris_default_dynamics();
    assert_memory_equal(&head.dynamics, &def, sizeof def);
    assert_true(def.lid_onset_ms < def.onset_ms && def.onset_ms < def.jaw_onset_ms &&
                def.onset_ms < def.release_ms);
    assert_true(head.muscle[0].onset_ms == def.onset_ms && head.muscle[0].release_ms == def.release_ms);
    ris_head_finish(&head);
    scratch_write("head.json", HEAD_START JAW ",\"dynamics\":{\"onset_ms\":5,\"jaw_onset_ms\":7}}");
    scratch_write("muscles.json",
                  MUSCLES_HEAD "{\"name\":\"masseter.L\",\"kind\":\"linear\",\"grid\":" GRID BOTH
                               ",\"release_ms\":0},{\"name\":\"masseter.R\",\"mirror_of\":\"masseter.L\"}]}");
    expect_loads(&head);
    assert_true(head.dynamics.onset_ms == 5 && head.dynamics.release_ms == def.release_ms);
    for (uint32_t k = 0; k < 2; k++) {
        assert_true(head.muscle[k].onset_ms == 7 && head.muscle[k].release_ms == 0);
    }
    ris_head_finish(&head);
    expect_refused("head.json", HEAD_START JAW ",\"dynamics\":{\"onset_ms\":-1}}",
                   "dynamics.onset_ms: expected a number of 0 to 2000, found -1");
    expect_refused("head.json", HEAD_START JAW ",\"dynamics\":{\"onset\":1}}", "dynamics.onset: unknown key");
    expect_refused("head.json", HEAD_START JAW ",\"dynamics\":1}", "dynamics: expected an object");
    expect_refused("muscles.json", CHEWING(",\"onset_ms\":3000"),
                   "muscles[0].onset_ms: expected a number of 0 to 2000, found 3000");
}

static void test_refuses_files(void **state)
{
    (void)state;
    static const char *const file[] = {"skin.obj", "regions.json", "depth.csv",        "muscles.json",
                                       "skin.map", "skin.png",     "expressions.json", "eye.obj"};
    ris_head head;
    ris_error err = {0};
    for (size_t i = 0; i < sizeof file / sizeof file[0]; i++) {
        char says[64];
        write_head();
        unlink(scratch_path(file[i]));
        snprintf(says, sizeof says, "%s: No such file", file[i]);
        expect_error(&err, ris_head_load(scratch_folder, &head, &err), RIS_ERROR_DATA, says);
        assert_non_null(strstr(err.text, "head.json:1:"));
    }
    unlink(scratch_path("head.json"));
    expect_error(&err, ris_head_load(scratch_folder, &head, &err), RIS_ERROR_DATA,
                 "head.json: cannot open: No such file");
    expect_error(&err, ris_head_load("", &head, &err), RIS_ERROR_DATA, "head.json: cannot open");
}

static void test_refuses_head_json(void **state)
{
    (void)state;
    expect_refused("head.json", "{\n\"format\":\n}", "head.json:3:1: ");
    expect_refused("head.json", "{\"format\":\"risorius-clip\",\"version\":1}",
                   "head.json:1:11: format: expected \"risorius-head\"");
    expect_refused("head.json", "{\"format\":\"risorius-head\",\"version\":2}",
                   "version: expected 1, found 2");
    expect_refused("head.json", HEAD_START JAW ",\"jwa\":1}", "jwa: unknown key; nearest: jaw");
    expect_refused("head.json", HEAD_START "}", "expected the key \"jaw\" with an object, found none");
    expect_refused("head.json", "{\"format\":\"risorius-head\",\"version\":1}",
                   "expected the key \"skin\" with a file name");
    expect_refused("head.json", "{\"format\":\"risorius-head\",\"version\":1,\"units\":\"cm\"}",
                   "units: expected one of mm, found \"cm\"");
    expect_refused("head.json", "{\"format\":\"risorius-head\",\"version\":1,\"skin\":\"\"}",
                   "skin: expected a file name");
    expect_refused("head.json", HEAD_START ",\"jaw\":{\"point\":[0,0],\"axis\":[1,0,0]}}",
                   "jaw.point: expected 3 numbers, found an array of 2");
    expect_refused("head.json", HEAD_START ",\"jaw\":{\"point\":[0,0,0],\"axis\":[0,0,0]}}",
                   "jaw.axis: expected a direction");
    expect_refused("head.json", HEAD_START ",\"jaw\":{\"point\":[0,0,0],\"axis\":[1,0,0],\"open_deg\":90}}",
                   "jaw.open_deg: expected a number of 0 to 60, found 90");
    expect_refused("head.json",
                   HEAD_START ",\"jaw\":{\"point\":[0,0,0],\"axis\":[1,0,0],\"eminence_deg\":80}}",
                   "jaw.eminence_deg: expected a number of 0 to 75, found 80");
    expect_refused("head.json",
                   HEAD_START
                   ",\"jaw\":{\"point\":[0,0,0],\"axis\":[1,0,0],\"eminence_mm\":7,\"forward_mm\":8}}",
                   "jaw.forward_mm: expected a number of 0 to 7, found 8");
    expect_refused("head.json", HEAD_START JAW ",\"tissue\":{\"modulus\":[5,1]}}",
                   "tissue.modulus: expected the low modulus first");
    expect_refused("head.json", HEAD_START JAW ",\"tissue\":{\"mass_g\":0}}",
                   "tissue.mass_g: expected a number of 1e-06 to 1000, found 0");
    expect_refused("head.json", HEAD_START JAW ",\"tissue\":{\"model\":\"waters\"}}",
                   "tissue.model: expected one of risorius, kaehler");
    expect_refused("head.json", HEAD_START JAW ",\"tissue\":{\"substeps\":99999}}",
                   "tissue.substeps: expected an integer of 1 to 1024");
    expect_refused("head.json",
                   HEAD_START JAW
                   ",\"tissue\":{\"anchors\":[{\"region\":\"lip\",\"normal\":1,\"tangential\":1}]}}",
                   "tissue.anchors[0].region: unknown region; nearest: lips");
    expect_refused("head.json", HEAD_START JAW ",\"parts\":[{\"name\":\"tongue\"}]}",
                   "parts[0]: expected the key \"bone\"");
    expect_refused(
        "head.json",
        HEAD_START JAW
        ",\"parts\":[{\"name\":\"e\",\"bone\":\"eye.L\",\"material\":\"eye\",\"mesh\":\"eye.obj\"}]}",
        "parts[0]: expected the key \"pivot\" with 3 numbers");
    expect_refused(
        "head.json",
        HEAD_START JAW
        ",\"parts\":[{\"name\":\"e\",\"bone\":\"jaw\",\"material\":\"wood\",\"mesh\":\"eye.obj\"}]}",
        "parts[0].material: expected one of skin, eye");
    expect_refused("head.json",
                   HEAD_START JAW
                   ",\"parts\":[{\"name\":\"e\",\"bone\":\"jaw\",\"material\":\"eye\",\"mesh\":\"eye.obj\"},"
                   "{\"name\":\"e\",\"bone\":\"jaw\",\"material\":\"eye\",\"mesh\":\"eye.obj\"}]}",
                   "parts[1].name: the part \"e\" is there already");
    expect_refused("eye.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n",
                   "eye.obj: face 0 has a triangle of zero area");
    expect_refused("skin.obj", SKIN "v 0 0 0\n", "skin.obj: vertex 6 is isolated");
    expect_refused("skin.obj", SKIN "v 0 nan 0\n", "skin.obj:10:5: expected a finite y, found \"nan\"");
    expect_refused("skin.obj", SKIN "f 1 2 77\n",
                   "skin.obj:10:7: expected a vertex index of the 6 above, found \"77\"");
}

static void test_refuses_regions(void **state)
{
    (void)state;
    expect_refused("regions.json", "{}", "expected 1 to 1024 regions, found 0");
    expect_refused("regions.json", "{\"face\":[[0,6]]}",
                   "regions.json:1:13: face[0][1]: expected an integer of 0 to 5, found 6");
    expect_refused("regions.json", "{\"face\":[[3,2]]}",
                   "face[0][1]: expected an integer of 3 to 5, found 2");
    expect_refused("regions.json", "{\"face\":[]}", "face: expected an array of 1 to");
    expect_refused("regions.json", "{\"face\":[[0]]}",
                   "face[0]: expected an array of 2, found an array of 1");
    expect_refused("regions.json", "{\"Face\":[[0,1]]}", "expected a region name in snake_case");
    expect_refused("regions.json", "{\"fac\":[[0,5]]}", "simulated: unknown region \"face\"; nearest: fac");
}

/* The border of the closed jaw: a grid that is kept, and every way in which it can be none. */
static void test_guidance(void **state)
{
    (void)state;
    static const char start[] = "forward_mm,side,open_deg\n";
    static const struct {
        const char *rows, *says;
    } wrong[] = {
        {"0,0,0\n0,1\n", "guidance.csv:3:4: expected a comma"},
        {"0,0,0\n0,2,1\n", "guidance.csv:3:3: expected a side of 0 to 1, found \"2,1\""},
        {"0,0,0\n0,1,99\n", "guidance.csv:3:5: expected an opening of -30 to 60 degrees"},
        {"-1,0,0\n-1,1,0\n0,0,0\n0,0.5,1\n",
         "guidance.csv:5:1: expected the next place of a full ascending grid"},
        {"0,0,0\n0,1,0\n-1,0,0\n-1,1,0\n", "guidance.csv:4:1: expected the next place"},
        {"0,0,0\n0,1,0\n1,0,0\n", "guidance.csv: expected a full grid of at least 2 steps forward by 2"},
        {"0,0,0\n0,1,0\n", "guidance.csv: expected a full grid"},
        {"0,0,0.5\n0,1,0\n1,0,0\n1,1,0\n", "guidance.csv: expected the row \"0,0,0\" of the closed jaw"},
    };
    ris_head head;
    write_head();
    scratch_write("guidance.csv",
                  "forward_mm,side,open_deg\n-1,0,0.5\n-1,1,1\n0,0,0\n0,1,2\n4,0,-1\n4,1,-2.5\n");
    scratch_write("head.json", HEAD_START JAW ",\"guidance\":\"guidance.csv\"}");
    expect_loads(&head);
    assert_true(head.guidance.forward_count == 3 && head.guidance.side_count == 2 &&
                head.guidance.forward_mm[2] == 4 && head.guidance.side[1] == 1 &&
                head.guidance.open_deg[5] == -2.5f);
    ris_head_finish(&head);
    for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
        char text[256];
        ris_error err = {0};
        snprintf(text, sizeof text, "%s%s", start, wrong[k].rows);
        scratch_write("guidance.csv", text);
        expect_error(&err, ris_head_load(scratch_folder, &head, &err), RIS_ERROR_DATA, wrong[k].says);
    }
    scratch_write("guidance.csv", "forward,side,open_deg\n");
    ris_error err = {0};
    expect_error(&err, ris_head_load(scratch_folder, &head, &err), RIS_ERROR_DATA,
                 "guidance.csv:1:1: expected the header \"forward_mm,side,open_deg\"");
    write_head();
}

static void test_refuses_tables(void **state)
{
    (void)state;
    expect_refused("depth.csv", "vertex,depth\n",
                   "depth.csv:1:1: expected the header \"vertex,depth_mm,jaw_weight\"");
    expect_refused("depth.csv", "vertex,depth_mm,jaw_weight\n0,5,0\n",
                   "depth.csv:3:1: expected one row for each of the 6 vertices");
    expect_refused("depth.csv", DEPTH "6,5,0\n", "expected one row for each of the 6 vertices, found more");
    expect_refused("depth.csv", "vertex,depth_mm,jaw_weight\n0,5,0\n2,5,0\n",
                   "depth.csv:3:1: expected vertex 1 and a comma, found \"2,5,0\"");
    expect_refused("depth.csv", "vertex,depth_mm,jaw_weight\n0,-5,0\n",
                   "depth.csv:2:3: expected a depth of 0 to 100 mm");
    expect_refused("depth.csv", "vertex,depth_mm,jaw_weight\n0,nan,0\n", "depth.csv:2:3: expected a depth");
    expect_refused("depth.csv", "vertex,depth_mm,jaw_weight\n0,5,1.5\n",
                   "depth.csv:2:5: expected a jaw weight of 0 to 1");
    expect_refused("depth.csv", "vertex,depth_mm,jaw_weight\n0,5,1,2\n",
                   "depth.csv:2:6: expected the end of the line");
    expect_refused("depth.csv", "vertex,depth_mm,jaw_weight\n0,5 ,1\n", "depth.csv:2:4: expected a comma");
    expect_refused("skin.map", "1\n2\n", "skin.map:3:1: expected one row for each of the 6 vertices");
    expect_refused("skin.map", "1\n-2\n", "skin.map:2:1: expected a base vertex or -1, found \"-2\"");
    expect_refused("skin.map", "1\n\n", "skin.map:2:1: expected a base vertex or -1");
    expect_refused("skin.map", "1\n2\n3\n4\n5\n6\n7\n", "found more");
}

static void test_refuses_muscles(void **state)
{
    (void)state;
    expect_refused("muscles.json", MUSCLES_HEAD "]}",
                   "muscles: expected an array of 1 to 1024, found an array of 0");
    expect_refused("muscles.json", MUSCLES_HEAD "{\"name\":\"Risorius\"}]}",
                   "muscles[0].name: expected a muscle name");
    expect_refused("muscles.json", MUSCLES_HEAD "{\"name\":\"a\"}]}",
                   "muscles[0]: expected the key \"kind\"");
    expect_refused("muscles.json", MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\"}]}",
                   "muscles[0]: expected the key \"grid\"");
    expect_refused("muscles.json",
                   MUSCLES_HEAD
                   "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":[[[1,2,3],[1,2,4]],[[1,2],[1,3,3]]]}]}",
                   "muscles[0].grid[1][0]: expected 3 numbers, found an array of 2");
    expect_refused("muscles.json",
                   MUSCLES_HEAD
                   "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":[[[1,2,3],[1,2,4]],[[1,2,3]]]}]}",
                   "muscles[0].grid[1]: expected 2 points, as in row 0, found an array of 1");
    expect_refused("muscles.json",
                   MUSCLES_HEAD
                   "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":[[[1,2,3],[1,2,4]],[[1,3,3],[1,2,4]]]}]}",
                   "muscles[0].grid[1][1]: the point coincides with the one of the row before");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":[[[1,2,3],[1,2,4]]]}]}",
                   "muscles[0].grid: expected an array of 2 to 256, found an array of 1");
    expect_refused("muscles.json",
                   MUSCLES_HEAD
                   "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":[[[1e9,2,3],[1,2,4]],[[1,3,3],[1,2,4]]]}]}",
                   "muscles[0].grid[0][0][0]: expected a number of -1000 to 1000, found 1e+09");
    expect_refused("muscles.json",
                   MUSCLES_HEAD
                   "{\"name\":\"a\",\"kind\":\"linear\",\"axis\":[[0,0,0],[0,0,1]],\"grid\":" GRID "}]}",
                   "muscles[0].axis: expected no axis for a linear muscle");
    expect_refused("muscles.json", MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"sphincter\",\"grid\":" GRID "}]}",
                   "muscles[0]: expected the key \"axis\" with an array of 2");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":" GRID
                                ",\"max_shortening\":0.9}]}",
                   "muscles[0].max_shortening: expected a number of 0 to 0.3, found 0.9");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":" GRID ",\"attach\":[6]}]}",
                   "muscles[0].attach[0]: expected an integer of 0 to 5, found 6");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":" GRID ",\"attach\":[3,3]}]}",
                   "muscles[0].attach[1]: expected an integer of 4 to 5, found 3");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":" GRID ",\"attach\":[5,5]}]}",
                   "muscles[0].attach[1]: expected no vertex after the last one");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":" GRID ",\"au\":[\"12\"]}]}",
                   "muscles[0].au[0]: expected an action unit such as \"AU12\", found \"12\"");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":" GRID
                                ",\"acts_on\":\"ear\"}]}",
                   "muscles[0].acts_on: expected one of skin, lip, lid, found \"ear\"");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":" GRID
                                ",\"acts_on\":\"lid\"}]}",
                   "muscles[0].acts_on: expected lid only for a muscle with a side, found \"lid\"");
    expect_refused(
        "muscles.json",
        MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"sphincter\",\"grid\":" GRID
                     ",\"axis\":[[0,0,10],[0,0,20]],\"acts_on\":\"lip\"}]}",
        "muscles[0].acts_on: expected skin for a sphincter (lid if it closes on a line), found \"lip\"");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":" GRID ",\"bowstring\":1.5}]}",
                   "muscles[0].bowstring: expected a number of 0 to 1, found 1.5");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"linear\",\"grid\":" GRID ",\"push_lip\":[1]}]}",
                   "muscles[0].push_lip: expected 2 numbers");
    expect_refused("muscles.json",
                   MUSCLES_HEAD "{\"name\":\"a\",\"kind\":\"sphincter\",\"grid\":" GRID
                                ",\"axis\":[[0,0,10],[0,0,20]],\"push_lip\":[1,0]}]}",
                   "muscles[0].push_lip: expected no push_lip but for a linear muscle that ends in the skin");
    expect_refused("muscles.json", MUSCLES_HEAD MUSCLE_L ",\n" MUSCLE_L "]}",
                   "muscles.json:2:9: muscles[1].name: the muscle \"risorius.L\" is there already");
    expect_refused("muscles.json",
                   MUSCLES_HEAD MUSCLE_L ",{\"name\":\"risorius\",\"kind\":\"linear\",\"grid\":" GRID "}]}",
                   "an unsided name means both sides");
    expect_refused("muscles.json",
                   MUSCLES_HEAD MUSCLE_L ",{\"name\":\"risorius.R\",\"mirror_of\":\"risorius.R\"}]}",
                   "muscles[1].mirror_of: expected this muscle's name with the other side");
    expect_refused("muscles.json", MUSCLES_HEAD "{\"name\":\"a.R\",\"mirror_of\":\"a.L\"}]}",
                   "expected a muscle of this file with its own grid");
    expect_refused("muscles.json",
                   MUSCLES_HEAD MUSCLE_L
                   ",{\"name\":\"risorius.R\",\"mirror_of\":\"risorius.L\",\"gain\":1}]}",
                   "muscles[1].gain: unknown key");
    expect_refused("muscles.json",
                   MUSCLES_HEAD MUSCLE_L
                   ",{\"name\":\"risorius.R\",\"mirror_of\":\"risorius.L\",\"attach\":[1]}]}",
                   "muscles[1].attach: expected \"auto\", as on the other side");
}

static void test_refuses_expressions(void **state)
{
    (void)state;
    expect_refused("expressions.json", EXPRESSIONS_HEAD "{\"smile\":{\"risoris\":1}}}",
                   "expressions.smile.risoris: unknown muscle, channel, unit, shape, viseme or expression; "
                   "nearest: risorius.R, risorius.L");
    expect_refused("expressions.json", EXPRESSIONS_HEAD "{\"smile\":{\"risorius\":\"x\"}}}",
                   "expressions.smile.risorius: expected a number");
    expect_refused("expressions.json", EXPRESSIONS_HEAD "{\"risorius\":{}}}",
                   "expressions.risorius: an expression may not carry the name of a muscle or channel");
    expect_refused("expressions.json", EXPRESSIONS_HEAD "{\"jaw.open\":{}}}", "name of a muscle or channel");
    expect_refused("expressions.json", EXPRESSIONS_HEAD "{\"AU12\":{}}}", "name of an action unit");
    expect_refused("expressions.json", EXPRESSIONS_HEAD "{\"viseme.PP\":{}}}", "name of a viseme");
    expect_refused("expressions.json", EXPRESSIONS_HEAD "{\"mouthSmileLeft\":{}}}", "name of an ARKit shape");
    expect_refused("expressions.json", EXPRESSIONS_HEAD "{\"a b\":{}}}", "expected an expression name");
    expect_refused("expressions.json", EXPRESSIONS_HEAD "{\"a\":{},\"a\":{}}}", "expressions.json:1:");
    expect_refused("expressions.json",
                   EXPRESSIONS_HEAD "{\"a\":{\"b\":1},\"b\":{\"c\":1},\"c\":{\"risorius\":1}}}",
                   "expressions.a.b: expressions may be nested one level deep only");
    expect_refused("expressions.json", EXPRESSIONS_HEAD "{\"a\":{\"a\":1}}}", "nested one level deep only");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_loads),
        cmocka_unit_test(test_mirrored_muscle),
        cmocka_unit_test(test_muscle_keys),
        cmocka_unit_test(test_jaw_muscle_keys),
        cmocka_unit_test(test_tissue),
        cmocka_unit_test(test_dynamics),
        cmocka_unit_test(test_refuses_files),
        cmocka_unit_test(test_refuses_head_json),
        cmocka_unit_test(test_guidance),
        cmocka_unit_test(test_refuses_regions),
        cmocka_unit_test(test_refuses_tables),
        cmocka_unit_test(test_refuses_muscles),
        cmocka_unit_test(test_refuses_expressions),
    };
    return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
