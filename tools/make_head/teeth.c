/* Teeth and gums (KA-06): sixteen crowns an arch on a superellipse fitted to the base mesh's teeth groups.
 * UV of the crowns: u along the arch from the subject's right (0) to the left (1), v from the gum (0) to the edge (1);
 * of the gums: the same u, v across the band from the outer fold (0) over the margin (0.5) to the inside (1). */
#include "make_head.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846
#define ARC_STEPS 512
#define HALF 8
#define AROUND 14
#define CANINE_MM 0.6

typedef struct arch {
    double half_width, front_z, back_z, power, edge_y, rise, crown_mm,
        fold_mm;       /* fold: height of the outer gum */
    double sign;       /* +1: edges point down (upper) */
    double back[HALF]; /* how far each tooth is set back into its jaw so that it only meets the other arch */
    double length[ARC_STEPS + 1]; /* arc length from the middle to sample k */
    dvec at[ARC_STEPS + 1];       /* on the edge line, left half */
} arch;

/* mesio-distal width, bucco-lingual depth, crown height factor, cusps */
typedef struct crown {
    double width, depth, height;
    int cusps;
} crown;

static const crown upper_crowns[HALF] = {{8.6, 7.0, 1.00, 0},  {6.7, 6.2, 0.90, 0}, {7.7, 7.8, 0.98, 1},
                                         {7.1, 8.8, 0.82, 2},  {6.8, 8.8, 0.78, 2}, {10.0, 10.6, 0.74, 4},
                                         {9.4, 10.4, 0.70, 4}, {8.4, 9.8, 0.64, 4}};
static const crown lower_crowns[HALF] = {{5.3, 5.8, 0.88, 0},  {5.8, 6.2, 0.92, 0}, {6.9, 7.5, 1.02, 1},
                                         {7.0, 7.7, 0.86, 2},  {7.1, 8.1, 0.80, 2}, {11.0, 10.1, 0.74, 4},
                                         {10.4, 9.9, 0.70, 4}, {9.6, 9.4, 0.64, 4}};

static void build_arch(const maker *m, const char *key, arch *a)
{
    json_t *rule = recipe_get(recipe_get(m->recipe, "teeth"), key);
    *a = (arch){.half_width = recipe_number(rule, "half_width"),
                .front_z = recipe_number(rule, "front_z"),
                .back_z = recipe_number(rule, "back_z"),
                .power = recipe_number(rule, "power"),
                .edge_y = recipe_number(rule, "edge_y"),
                .rise = recipe_number(rule, "rise_mm"),
                .crown_mm = recipe_number(rule, "crown_mm"),
                .fold_mm = recipe_number(rule, "fold_mm"),
                .sign = strcmp(key, "upper") == 0 ? 1 : -1};
    for (int k = 0; k <= ARC_STEPS; k++) {
        double angle = 0.5 * PI * k / ARC_STEPS, e = 2 / a->power;
        double x = a->half_width * pow(sin(angle), e), f = pow(cos(angle) > 0 ? cos(angle) : 0, e);
        a->at[k] = v3(x, a->edge_y + a->rise * pow(1 - f, 1.15), a->back_z + (a->front_z - a->back_z) * f);
        a->length[k] = k ? a->length[k - 1] + v_length(v_sub(a->at[k], a->at[k - 1])) : 0;
    }
}

/* Point and frame at arc length s from the middle (left half; negative = right). out is away from the tongue. */
static dvec arch_at(const arch *a, double s, dvec *along, dvec *out)
{
    double length = fabs(s);
    int k = 1;
    while (k < ARC_STEPS && a->length[k] < length)
        k++;
    double t = (length - a->length[k - 1]) / (a->length[k] - a->length[k - 1]);
    dvec p = v_mix(a->at[k - 1], a->at[k], t), d = v_sub(a->at[k], a->at[k - 1]);
    *along = v_unit(v3(d.x, 0, d.z));
    if (s < 0) {
        p.x = -p.x;
        *along = v3(along->x, 0, -along->z);
    }
    *out = v_cross(*along, v3(0, 1, 0));
    return p;
}

/* Half width and half depth at height h (0 = gum line, 1 = edge), and how far the section leans outwards. */
static void section(const crown *c, double h, double *width, double *depth, double *lean)
{
    double waist = 0.78 + 0.22 * smoothstep(-0.1, 0.62, h); /* narrower at the neck */
    *width = 0.497 * c->width * waist;
    if (c->cusps <= 1) { /* incisors and canines: wedge-shaped, lip side nearly flat */
        double thin = 1 - 0.80 * smoothstep(0.05, 1.0, h);
        *depth = 0.40 * c->depth * thin;
        *lean = 0.40 * c->depth * (0.2 - thin) * 0.72 + 0.5 * sin(PI * clamp(h, 0, 1)) -
                0.3 * (h - 1); /* 0 at the edge */
        if (c->cusps == 1)
            *width *= 1 - 0.30 * smoothstep(0.55, 1.0, h);
    } else {
        *depth = 0.46 * c->depth * (0.92 + 0.08 * sin(PI * clamp(h, 0, 1)) - 0.22 * smoothstep(0.55, 1, h));
        *lean = 0;
    }
}

static double cusp_height(const crown *c, double x, double z)
{
    if (c->cusps == 2)
        return 0.7 * (z * z - 0.45) - 0.2 * x * x;
    if (c->cusps == 4)
        return 1.1 * (fabs(x) * fabs(z) * 2 - 0.55 + 0.35 * z * z);
    return 0;
}

static void close_fan(part *p, uint32_t middle, uint32_t ring, bool turned)
{
    for (uint32_t k = 0; k < AROUND; k++) {
        uint32_t n = (k + 1) % AROUND;
        part_triangle(p, middle, ring + (turned ? k : n), ring + (turned ? n : k));
    }
}

/* Rings from below the gum to the edge, then the chewing surface; closed at both ends. */
static void add_tooth(part *p, const arch *a, const crown *c, double centre, double u0, double u1)
{
    dvec along, out, base = arch_at(a, centre, &along, &out), up = v3(0, a->sign, 0);
    double height = a->crown_mm * c->height;
    static const double levels[] = {-0.22, 0.0, 0.16, 0.36, 0.58, 0.78, 0.90, 0.97, 1.0};
    uint32_t first = p->vertex_count, last = NONE, count = sizeof levels / sizeof *levels;
    for (uint32_t r = 0; r < count + 2; r++) {
        double h = levels[r < count ? r : count - 1], inset = r < count ? 1 : r == count ? 0.62 : 0.30;
        double width, depth, lean;
        section(c, h, &width, &depth, &lean);
        double round_off = r + 1 == count ? 0.93 : 1;
        uint32_t ring = p->vertex_count;
        for (uint32_t k = 0; k < AROUND; k++) {
            double angle = 2 * PI * k / AROUND, cx = cos(angle), cz = sin(angle);
            double sx = copysign(pow(fabs(cx), 0.72), cx) * inset,
                   sz = copysign(pow(fabs(cz), 0.80), cz) * inset;
            double y = height * (1 - h) -
                       (r < count ? 0.9 * smoothstep(0.85, 1.0, h) : 0.9) * cusp_height(c, sx, sz);
            if (c->cusps == 1) /* the tip of the canine stands proud; worn, or it looks a fang */
                y -= smoothstep(0.7, 1.0, h) * (CANINE_MM * (1 - fabs(sx)) - 0.35 * fabs(sx));
            dvec at = v_mad(
                v_mad(v_mad(base, along, sx * width * round_off), out, sz * depth * round_off + lean), up, y);
            part_vertex(p, at, u0 + (u1 - u0) * (0.5 + 0.5 * sx), clamp(h, 0, 1));
        }
        for (uint32_t k = 0; k < AROUND && last != NONE; k++) {
            uint32_t n = (k + 1) % AROUND;
            if (a->sign > 0)
                part_quad(p, last + k, last + n, ring + n, ring + k);
            else
                part_quad(p, last + n, last + k, ring + k, ring + n);
        }
        last = ring;
    }
    double width, depth, lean;
    section(c, levels[0], &width, &depth, &lean);
    uint32_t root =
        part_vertex(p, v_mad(v_mad(base, out, lean), up, height * (1.1 - levels[0])), (u0 + u1) / 2, 0);
    close_fan(p, root, first, a->sign < 0);
    section(c, 1, &width, &depth, &lean);
    double y = -0.9 * cusp_height(c, 0, 0) - (c->cusps == 1 ? CANINE_MM : 0);
    uint32_t tip = part_vertex(p, v_mad(v_mad(base, out, lean), up, y), (u0 + u1) / 2, 1);
    close_fan(p, tip, last, a->sign > 0);
}

static double arch_scale(const arch *a, const crown *crowns)
{
    double sum = 0;
    for (int k = 0; k < HALF; k++)
        sum += crowns[k].width;
    return (a->length[ARC_STEPS] - 1.0) / sum;
}

static part build_teeth(const arch *a, const crown *crowns)
{
    part left = {0};
    double scale = arch_scale(a, crowns), s = 0;
    for (int k = 0; k < HALF; k++) {
        crown c = crowns[k];
        uint32_t first = left.vertex_count;
        c.width *= scale;
        add_tooth(&left, a, &c, s + c.width / 2, 0.5 + 0.5 * k / HALF, 0.5 + 0.5 * (k + 1) / HALF);
        for (uint32_t i = first; i < left.vertex_count; i++)
            left.position[i].y += a->sign * a->back[k];
        s += c.width;
    }
    part right = part_mirrored(&left);
    for (uint32_t i = 0; i < right.vertex_count; i++)
        right.uv[i][0] = 1 - right.uv[i][0];
    part_append(&left, &right);
    part_finish(&right);
    return left;
}

/* Gum: a band over the jaw ridge; its margin is scalloped, low over the middle of a tooth and rising between two.
 * Station at arc length s; the eleven points run from the outer fold over the margin to the inside. */
enum { GUM_POINTS = 11, GUM_PER_TOOTH = 7 };

static void gum_station(part *p, const arch *a, const crown *c, double s, double in_tooth, double back,
                        double u)
{
    dvec along, out, base = arch_at(a, s, &along, &out), up = v3(0, a->sign, 0);
    base.y += a->sign * back;
    double width, depth, lean;
    section(c, 0.05, &width, &depth, &lean);
    double between = pow(fabs(2 * in_tooth - 1), 2.4), line = a->crown_mm * c->height;
    double margin = line - 0.6 - 2.6 * between, thin = 1 - 0.3 * between;
    double x = fabs(in_tooth - 0.5) / 0.378; /* the neck's section: |x|^2.78 + |z|^2.5 = 1 */
    double o = depth * (x < 1 ? 0.45 + 0.55 * pow(1 - pow(x, 2.78), 0.4) : 0.45), swell = 1 - 0.25 * between;
    const double profile[GUM_POINTS][2] = {{depth + 0.3, line + a->fold_mm},
                                           {depth + 0.9, line + 0.68 * a->fold_mm},
                                           {o + 1.1 * swell, line + 0.38 * a->fold_mm},
                                           {o + 0.8 * swell, line + 0.16 * a->fold_mm},
                                           {o * thin + 0.3, margin},
                                           {0, margin - 0.1 + 0.5 * (1 - between)},
                                           {-o * thin - 0.3, margin},
                                           {-o - 0.9 * swell, line + 1.0},
                                           {-depth - 1.5, line + 3.0},
                                           {-depth - 2.1, line + 5.0},
                                           {-depth - 2.4, line + 7.0}};
    for (int k = 0; k < GUM_POINTS; k++)
        part_vertex(p, v_mad(v_mad(base, out, profile[k][0] + lean), up, profile[k][1]), u,
                    k / (GUM_POINTS - 1.0));
}

/* A strip of quads over the end section: outer points to their partners inside. */
static void close_gum_end(part *p, uint32_t first, bool turned)
{
    for (uint32_t k = 0; k < GUM_POINTS / 2; k++) {
        uint32_t a = first + k, b = first + k + 1, c = first + GUM_POINTS - 2 - k,
                 d = first + GUM_POINTS - 1 - k;
        if (b == c)
            part_triangle(p, a, turned ? b : d, turned ? d : b);
        else if (turned)
            part_quad(p, a, b, c, d);
        else
            part_quad(p, a, d, c, b);
    }
}

static part build_gum(const arch *a, const crown *crowns)
{
    part p = {0};
    double scale = arch_scale(a, crowns), total = a->length[ARC_STEPS] - 1.0;
    uint32_t stations = 2 * HALF * GUM_PER_TOOTH + 1;
    for (uint32_t i = 0; i < stations; i++) {
        int from_middle = (int)i - HALF * GUM_PER_TOOTH, k = abs(from_middle) / GUM_PER_TOOTH;
        double start = 0, in_tooth = (double)(abs(from_middle) % GUM_PER_TOOTH) / GUM_PER_TOOTH;
        if (k == HALF) {
            k = HALF - 1;
            in_tooth = 1;
        }
        for (int j = 0; j < k; j++)
            start += crowns[j].width * scale;
        double s = start + in_tooth * crowns[k].width * scale;
        crown c = crowns[k];
        int other = in_tooth < 0.5 ? k - 1 : k + 1; /* sections change smoothly from tooth to tooth */
        double share = fabs(in_tooth - 0.5), back = a->back[k];
        if (other >= 0 && other < HALF) {
            c.depth += share * (crowns[other].depth - c.depth);
            c.height += share * (crowns[other].height - c.height);
            back += share * (a->back[other] - back);
        }
        c.cusps = k < 3 ? 0 : 2;
        gum_station(&p, a, &c, from_middle < 0 ? -s : s, in_tooth, back,
                    0.5 + 0.5 * (from_middle < 0 ? -s : s) / total);
    }
    for (uint32_t i = 0; i + 1 < stations; i++) /* the last strip closes the band underneath */
        for (uint32_t k = 0; k < GUM_POINTS; k++) {
            uint32_t v = i * GUM_POINTS + k, n = i * GUM_POINTS + (k + 1) % GUM_POINTS;
            if (a->sign < 0)
                part_quad(&p, v, v + GUM_POINTS, n + GUM_POINTS, n);
            else
                part_quad(&p, v, n, n + GUM_POINTS, v + GUM_POINTS);
        }
    close_gum_end(&p, 0, a->sign < 0);
    close_gum_end(&p, (stations - 1) * GUM_POINTS, a->sign > 0);
    return p;
}

void write_teeth(const maker *m)
{
    static const char *const keys[] = {"upper", "lower"};
    static const crown *const crowns[] = {upper_crowns, lower_crowns};
    arch arches[2];
    part first[2];
    for (int i = 0; i < 2; i++) {
        build_arch(m, keys[i], &arches[i]);
        first[i] = build_teeth(&arches[i], crowns[i]);
    }
    occlude(&first[1], &first[0], HALF, recipe_number(recipe_get(m->recipe, "teeth"), "gap_mm"),
            arches[1].back, arches[0].back);
    for (int i = 0; i < 2; i++) {
        char name[64];
        part teeth = build_teeth(&arches[i], crowns[i]), gum = build_gum(&arches[i], crowns[i]);
        snprintf(name, sizeof name, "teeth_%s.obj", keys[i]);
        write_part(m, &teeth, name);
        snprintf(name, sizeof name, "gum_%s.obj", keys[i]);
        write_part(m, &gum, name);
        printf("%s teeth: %u vertices, widths x %.3f, set back", keys[i], teeth.vertex_count,
               arch_scale(&arches[i], crowns[i]));
        for (int k = 0; k < HALF; k++)
            printf(" %.2f", arches[i].back[k]);
        printf(" mm\n");
        part_finish(&teeth);
        part_finish(&gum);
        part_finish(&first[i]);
    }
}
