/* Eyeballs and corneas (KA-06): a sphere in polar rings round the optical axis, an iris disc set back behind the
 * limbus, and a steeper spherical cap for the cornea. UV: azimuthal equidistant, centre (0.5, 0.5) on the axis,
 * radius 0.5 at the back pole, u to the subject's left, v up. */
#include "make_head.h"

#include <math.h>

#define PI 3.14159265358979323846

typedef struct eye_shape {
    dvec centre;
    double radius, iris_radius, iris_depth, cornea_curvature, limbus, back_angle;
    uint32_t around;
} eye_shape;

static uint32_t add_ring(part *p, const eye_shape *e, double rho, double z, double angle)
{
    uint32_t first = p->vertex_count;
    for (uint32_t k = 0; k < e->around; k++) {
        double a = 2 * PI * k / e->around, c = cos(a), s = sin(a), r = 0.5 * angle / PI;
        part_vertex(p, v_add(e->centre, v3(rho * c, rho * s, z)), 0.5 + r * c, 0.5 + r * s);
    }
    return first;
}

/* inner is nearer to the axis; outward is +z for a cap. */
static void join_rings(part *p, uint32_t inner, uint32_t outer, uint32_t around)
{
    for (uint32_t k = 0; k < around; k++) {
        uint32_t n = (k + 1) % around;
        part_quad(p, inner + k, outer + k, outer + n, inner + n);
    }
}

static uint32_t add_pole(part *p, const eye_shape *e, double z)
{
    return part_vertex(p, v_add(e->centre, v3(0, 0, z)), 0.5, 0.5);
}

static void join_pole(part *p, uint32_t pole, uint32_t ring, uint32_t around)
{
    for (uint32_t k = 0; k < around; k++)
        part_triangle(p, pole, ring + k, ring + (k + 1) % around);
}

/* Iris disc (a shallow cone that deepens towards the pupil), the step at the limbus, then the sclera. */
static part build_ball(const eye_shape *e)
{
    part p = {0};
    double edge = asin(e->iris_radius / e->radius), edge_z = e->radius * cos(edge);
    uint32_t pole = add_pole(&p, e, edge_z - e->iris_depth - 0.25), last = NONE;
    for (int r = 1; r <= 6; r++) {
        double t = r / 6.0, rho = e->iris_radius * t;
        double rim = r == 6 ? 0.5 : 1; /* the root of the iris curls up to the sclera */
        uint32_t ring =
            add_ring(&p, e, rho, edge_z - rim * (e->iris_depth + 0.25 * (1 - t)), asin(rho / e->radius));
        if (last == NONE)
            join_pole(&p, pole, ring, e->around);
        else
            join_rings(&p, last, ring, e->around);
        last = ring;
    }
    int steps = 18;
    for (int r = 0; r <= steps; r++) {
        double t = (double)r / steps, angle = edge + 0.018 + (e->back_angle - edge - 0.018) * pow(t, 1.25);
        uint32_t ring = add_ring(&p, e, e->radius * sin(angle), e->radius * cos(angle), angle);
        join_rings(&p, last, ring, e->around);
        last = ring;
    }
    return p;
}

static part build_cornea(const eye_shape *e)
{
    part p = {0};
    double base_z = sqrt(e->radius * e->radius - e->limbus * e->limbus), c = e->cornea_curvature;
    double centre_z = base_z - sqrt(c * c - e->limbus * e->limbus);
    uint32_t pole = add_pole(&p, e, centre_z + c), last = NONE;
    for (int r = 1; r <= 10; r++) {
        double rho = e->limbus * r / 10.0, z = centre_z + sqrt(c * c - rho * rho);
        z += 0.04 * (1 - (r == 10 ? 1.5 : 1)); /* the last ring dips just under the sclera */
        uint32_t ring = add_ring(&p, e, rho, z, asin(rho / e->radius));
        if (last == NONE)
            join_pole(&p, pole, ring, e->around);
        else
            join_rings(&p, last, ring, e->around);
        last = ring;
    }
    return p;
}

static void write_both(const maker *m, part *left, const char *name)
{
    char file[64];
    snprintf(file, sizeof file, "%s.L.obj", name);
    write_part(m, left, file);
    part right = part_mirrored(left);
    snprintf(file, sizeof file, "%s.R.obj", name);
    write_part(m, &right, file);
    part_finish(&right);
    part_finish(left);
}

void write_eyes(const maker *m)
{
    json_t *rule = recipe_get(m->recipe, "eye");
    double centre[3];
    recipe_numbers(rule, "centre", centre, 3);
    eye_shape e = {v3(centre[0], centre[1], centre[2]),
                   recipe_number(rule, "radius"),
                   recipe_number(rule, "iris_radius"),
                   recipe_number(rule, "iris_depth"),
                   recipe_number(rule, "cornea_curvature"),
                   recipe_number(rule, "limbus"),
                   recipe_number(rule, "back_angle_deg") * PI / 180,
                   40};
    part ball = build_ball(&e), cornea = build_cornea(&e);
    write_both(m, &ball, "eye");
    write_both(m, &cornea, "cornea");
    dvec pivot = to_head(&m->frame, e.centre);
    printf("eye pivots +-%.6f, %.6f, %.6f\n", pivot.x, pivot.y, pivot.z);
}
