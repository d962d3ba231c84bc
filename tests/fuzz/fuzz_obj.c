/* OBJ reader and mesh check. */
#include "fuzz.h"

#include "risorius/head.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ris_mesh mesh;
    ris_error err = {0};
    ris_result result = ris_mesh_parse_obj("input", (const char *)data, size, &mesh, &err);
    fuzz_check_error(result, &err);
    FUZZ_CHECK(result == RIS_OK || (!mesh.position && mesh.vertex_count == 0 && mesh.face_count == 0));
    if (result == RIS_OK) {
        FUZZ_CHECK(mesh.vertex_count > 0 && mesh.face_count > 0 && mesh.face_start[0] == 0);
        for (uint32_t f = 0; f < mesh.face_count; f++) {
            FUZZ_CHECK(mesh.face_start[f + 1] >= mesh.face_start[f] + 3);
        }
        for (uint32_t c = 0; c < mesh.face_start[mesh.face_count]; c++) {
            FUZZ_CHECK(mesh.face_vertex[c] < mesh.vertex_count);
            FUZZ_CHECK(mesh.face_uv[c] == UINT32_MAX || mesh.face_uv[c] < mesh.uv_count);
        }
        for (uint32_t v = 0; v < mesh.vertex_count; v++) {
            FUZZ_CHECK(isfinite(mesh.position[v].x) && isfinite(mesh.position[v].y) &&
                       isfinite(mesh.position[v].z));
        }
        ris_error check_err = {0};
        fuzz_check_error(ris_mesh_check(&mesh, "input", &check_err), &check_err);
    }
    ris_mesh_finish(&mesh);
    return 0;
}
