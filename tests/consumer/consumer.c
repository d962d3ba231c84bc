/* A stranger's program: loads a head with the installed library, smiles for half a second, reads the vertices. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <risorius/sim.h>
#include <risorius/timeline.h>

static int fail(const ris_error *err)
{
    fprintf(stderr, "consumer: %s\n", err->text);
    return ris_exit_code(err->code);
}

int main(int argc, char **argv)
{
    ris_error err = {0};
    ris_model *model = NULL;
    ris_sim *sim = NULL;
    if (argc != 2) {
        fprintf(stderr, "usage: consumer HEAD\n");
        return 2;
    }
    if (ris_model_load(argv[1], &model, &err) || ris_sim_create_cpu(model, &sim, &err)) {
        ris_model_destroy(model);
        return fail(&err);
    }

    float *pose = calloc(model->channel_count, sizeof *pose);
    ris_vec4 *position = calloc(model->node_count, sizeof *position);
    ris_result result = pose && position ? RIS_OK : ris_fail(&err, RIS_ERROR_MEMORY, "out of memory");
    if (!result) {
        result = ris_pose_parse(model, "zygomaticus_major=1", pose, &err);
    }
    for (int tick = 0; !result && tick < 30; tick++) {
        result = ris_sim_tick(sim, pose, &err);
    }
    if (!result) {
        result = ris_sim_read(sim, RIS_STATE_POSITION, position, &err);
    }

    double farthest = 0;
    for (uint32_t i = 0; !result && i < model->node_count; i++) {
        double x = position[i].x - model->rest_position[i].x, y = position[i].y - model->rest_position[i].y,
               z = position[i].z - model->rest_position[i].z;
        farthest = fmax(farthest, sqrt(x * x + y * y + z * z));
    }
    if (!result) {
        printf("%u vertices, the smile moves them by up to %.2f mm\n", model->node_count, farthest);
    }
    free(position);
    free(pose);
    ris_sim_destroy(sim);
    ris_model_destroy(model);
    return result ? fail(&err) : !(farthest > 1.0);
}
