/* The mandible at rest, built for the reference head (KA-04): teeth nearly closed, condyles before the ear
 * canals. */
#include "make_skull.h"

static const shape parts[] = {
    {.name = "body",
     .kind = SHAPE_CURVE,
     .count = 7,
     .point = {{0, -74.5, 76},
               {11, -74.5, 74.5},
               {21, -73.5, 67.5},
               {28.5, -71, 56.5},
               {34, -68, 45},
               {38, -64.5, 34},
               {40.5, -60, 25}},
     .size = {{5, 11}, {5.2, 11.2}, {5.4, 10.8}, {5.4, 10.5}, {4.8, 10.5}, {4, 10}, {3.2, 8}}},
    {.name = "alveolar part",
     .kind = SHAPE_CURVE,
     .blend = 5,
     .count = 7,
     .point = {{0, -68.3, 83},
               {8, -68.3, 81},
               {15, -68, 76.5},
               {20.5, -65.8, 67.5},
               {25, -62.5, 57.5},
               {27.5, -59, 49},
               {29.5, -55, 42.5}},
     .size = {{3.6, 6}, {3.8, 6}, {4.4, 6.5}, {4.6, 6.5}, {5.4, 7}, {5.4, 6.5}, {4.2, 5}}},
    {.name = "mental protuberance",
     .kind = SHAPE_ELLIPSOID,
     .blend = 6,
     .point = {{0, -79.5, 77.5}},
     .radius = {8, 6.5, 6}},
    {.name = "mental tubercle",
     .kind = SHAPE_ELLIPSOID,
     .blend = 6,
     .point = {{11, -82, 74.5}},
     .radius = {7, 4.5, 5}},
    {.name = "ramus",
     .kind = SHAPE_PLATE,
     .blend = 6,
     .count = 16,
     .point = {{7, -9, 0},
               {15, -9, 0},
               {18, -15, 0},
               {23, -19, 0},
               {29, -17.5, 0},
               {33, -11, 0},
               {37, -6.5, 0},
               {40.5, -8, 0},
               {43.5, -17, 0},
               {45.5, -30, 0},
               {47.5, -42, 0},
               {51, -55, 0},
               {44, -72, 0},
               {27, -69, 0},
               {17, -60, 0},
               {11, -38, 0}},
     .radius = {2.8, 0, 0},
     .rounding = 2.5,
     .sheet = {49.2, 0.155, -0.07}},
    {.name = "ramus, front edge",
     .kind = SHAPE_CURVE,
     .blend = 4,
     .count = 5,
     .point = {{44, -15, 40}, {41.8, -26, 42}, {40, -39, 44.5}, {37, -52, 49}, {33.5, -62, 56}},
     .size = {{2.2, 2.2}, {2.8, 2.8}, {3.2, 3.2}, {3.6, 3.6}, {3, 3}},
     .up = {0, 0, 1}},
    {.name = "ramus, back edge",
     .kind = SHAPE_CURVE,
     .blend = 5,
     .count = 4,
     .point = {{47.5, -14, 11.3}, {44, -30, 11.5}, {41.5, -48, 15}, {40, -59, 20}},
     .size = {{3.4, 3.6}, {3.3, 3.6}, {3.3, 3.6}, {3.4, 4.5}},
     .up = {0, 0, 1}},
    {.name = "condyle",
     .kind = SHAPE_ELLIPSOID,
     .blend = 4,
     .point = {{49, -7.2, 11}},
     .radius = {9.5, 4.6, 4.4},
     .turn = {0, 12, 0}},
    {.name = "mental foramen",
     .kind = SHAPE_CAPSULE,
     .op = SHAPE_CUT,
     .blend = 1,
     .point = {{30, -72, 71}, {22, -73, 64}},
     .size = {{1.7, 1.7}, {1.5, 1.5}}},
    {.name = "submandibular fossa",
     .kind = SHAPE_ELLIPSOID,
     .op = SHAPE_CUT,
     .blend = 5,
     .point = {{23, -76, 42}},
     .radius = {8, 7, 16},
     .turn = {0, -28, 0}},
};

/* Root bulges over the roots of the lower teeth: neck and apex, radius. */
static const double juga[][7] = {
    {2.6, -63.5, 85.3, 2.6, -73, 82.5, 1.9}, {7.7, -63.8, 83.9, 7.4, -73, 81, 2},
    {12.6, -64.4, 81, 12.4, -76, 78.5, 2.6}, {18, -61.5, 76.4, 18, -70, 73.5, 2.4},
    {22, -59.5, 70.4, 21.8, -68, 68, 2.4},   {26.2, -57, 63, 26.2, -65, 61, 2.8},
};

/* Least depth under the skin. */
double mandible_clearance(dvec p)
{
    (void)p;
    return 5;
}

void mandible_shapes(solid *s)
{
    size_t count = sizeof parts / sizeof *parts;
    for (size_t i = 0; i < count - 2; i++)
        solid_add(s, &parts[i]);
    for (size_t i = 0; i < sizeof juga / sizeof *juga; i++) {
        const double *j = juga[i];
        shape root = {.name = "jugum",
                      .kind = SHAPE_CAPSULE,
                      .blend = 2.5,
                      .point = {{j[0], j[1], j[2]}, {j[3], j[4], j[5]}},
                      .size = {{j[6], 0}, {0.6 * j[6], 0}}};
        solid_add(s, &root);
    }
    solid_add(s, &parts[count - 2]);
    solid_add(s, &parts[count - 1]);
}
