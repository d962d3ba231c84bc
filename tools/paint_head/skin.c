/* Skin colour from two pigments: melanin and haemoglobin absorb with their own spectra, so that every
 * local change (blush, freckle, lip) stays a colour that skin can have. Then stubble, light blood under
 * the eyes, baked hollows. */
#include "paint.h"

#include <math.h>

/* bare dermis, and the absorbance of one unit of each pigment, linear RGB */
static const float dermis[3] = {0.70f, 0.495f, 0.395f};
static const float melanin[3] = {0.30f, 0.50f, 0.82f};
static const float blood[3] = {0.10f, 0.74f, 0.56f};

typedef struct pigment {
    float melanin, blood, shade; /* shade: neutral absorbance */
    float cold;                  /* absorbance of red alone: veins and hair under the skin */
} pigment;

static ris_vec3 at_size(ris_vec3 p, float size_mm)
{
    return vec3_scale(p, 1 / size_mm);
}

/* Base tone by region of the face: yellow forehead, red centre, grey lower third. */
static void tone(const ris_paint_zones *z, pigment *ink)
{
    ink->melanin = 0.52f + 0.05f * z->forehead + 0.03f * z->lower_face + 0.04f * z->neck;
    ink->blood = 0.34f - 0.05f * z->forehead - 0.04f * z->neck + 0.02f * z->scalp;
    ink->blood += 0.19f * z->nose + 0.15f * z->ala + 0.17f * z->cheek + 0.22f * z->ear + 0.08f * z->chin;
    ink->blood +=
        0.10f * z->lid + 0.22f * z->rim + 0.09f * z->fold + 0.14f * z->lip_corner + 0.07f * z->under_eye;
    ink->melanin +=
        0.10f * z->lid + 0.10f * z->under_eye + 0.05f * z->fold + 0.10f * z->lip_corner + 0.05f * z->rim;
    ink->cold = 0.035f * z->lower_face + 0.07f * z->under_eye;
    ink->shade = 0.03f * z->under_eye - 0.03f * z->lip_roll;
    ink->shade += 0.30f * z->lash + 0.10f * z->crease;
    ink->melanin += 0.15f * z->lash + 0.10f * z->crease;
    ink->blood += 0.45f * z->caruncle + 0.5f * z->socket + 0.9f * z->nostril;
    ink->shade += 2.2f * z->nostril;
}

/* Unevenness at every scale: flush patches, mottling, tiny vessels, freckles, a few moles. */
static void mottle(const ris_paint_zones *z, ris_vec3 p, float s, pigment *ink)
{
    const float flush = ris_paint_fbm(at_size(p, 26 * s), 3, 31),
                patch = ris_paint_fbm(at_size(p, 7 * s), 3, 37);
    const float speck = ris_paint_fbm(at_size(p, 1.8f * s), 2, 41),
                brown = ris_paint_fbm(at_size(p, 16 * s), 4, 43);
    const float central = fminf(1, z->cheek + z->nose + z->ala + 0.5f * z->chin);
    const float even = 1 - 0.65f * z->scalp; /* hair hides the mottling */
    ink->blood +=
        even * ((0.12f + 0.05f * central) * flush + (0.14f + 0.07f * central) * patch + 0.08f * speck);
    ink->melanin += even * (0.15f * brown + 0.05f * speck);
    const float vessel = 1 - fabsf(ris_paint_fbm(at_size(p, 4 * s), 2, 47)) * 7;
    ink->blood += 0.10f * fmaxf(0, vessel) * (0.25f * z->cheek + 0.8f * z->ala);
    const ris_paint_cell freckle = ris_paint_cells(at_size(p, 4.2f * s), 53);
    const float rare = (float)(freckle.id & 255u) / 255.0f,
                size = 0.10f + 0.12f * (float)(freckle.id >> 8 & 255u) / 255.0f;
    const float sunny = 0.10f + 0.34f * fminf(1, z->cheek + z->nose) + 0.10f * z->forehead;
    if (rare < sunny && z->lip < 0.1f)
        ink->melanin +=
            0.42f * ris_paint_step(size, 0.3f * size, freckle.near) * (0.4f + 0.6f * (1 - rare / sunny));
    const ris_paint_cell mole = ris_paint_cells(at_size(p, 34 * s), 59);
    const float radius = 0.018f + 0.016f * (float)(mole.id >> 8 & 255u) / 255.0f;
    if ((mole.id & 255u) < 70 && z->lip < 0.1f)
        ink->melanin += 1.1f * ris_paint_step(radius * 1.15f, radius * 0.7f, mole.near);
}

/* Red of the lips with fine upright lines, darker towards the wet line; the mouth behind. */
static void lips(const ris_paint_zones *z, ris_vec3 p, float s, pigment *ink)
{
    const float lines = ris_paint_fbm(vec3(p.x / (0.75f * s), p.y / (7 * s), p.z / (9 * s)), 2, 61);
    const float patch = ris_paint_fbm(at_size(p, 4 * s), 2, 67);
    const float red = 0.62f + 0.12f * patch + 0.12f * lines + 0.35f * z->inner_lip;
    ink->blood = ris_paint_mix(ink->blood, 0.30f + red, z->lip);
    ink->melanin = ris_paint_mix(ink->melanin, 0.58f, z->lip);
    ink->cold = ris_paint_mix(ink->cold, 0.08f, z->lip);
    ink->shade += z->lip * (0.12f + 0.06f * lines) + 0.05f * z->lip_corner;
    const float deep = z->inner_mouth;
    ink->blood = ris_paint_mix(ink->blood, 1.05f + 0.15f * patch, deep);
    ink->melanin = ris_paint_mix(ink->melanin, 0.25f, deep);
    ink->shade = ris_paint_mix(ink->shade, 0.04f, deep);
}

/* Cut hairs in the scalp: a dot per follicle where the density allows, and their grey shine through the
 * skin. */
static void stubble(const ris_paint_zones *z, ris_vec3 p, float brow, pigment *ink)
{
    const ris_paint_cell hair = ris_paint_cells(at_size(p, 0.95f), 71);
    const float chance = (float)(hair.id & 1023u) / 1023.0f;
    const float thick =
        0.92f + 0.12f * ris_paint_fbm(at_size(p, 20), 3, 73) + 0.12f * ris_paint_fbm(at_size(p, 2.5f), 2, 74);
    const float density = z->scalp * thick;
    const float dot = chance < density ? ris_paint_step(0.62f, 0.15f, hair.near) : 0;
    ink->shade += 1.0f * density + 0.34f * dot;
    ink->cold += 0.38f * density;
    ink->melanin += 0.04f * density;
    ink->blood -= 0.06f * density;
    ink->shade += 0.55f * brow;
    ink->melanin += 0.40f * brow;
}

/* Fine relief, 0 = mean: pores, the criss-cross of thin skin, lines of forehead and lips, stubble. mm-ish,
 * about -1..1 */
static float relief(const ris_paint_zones *z, ris_vec3 p, float s, float *pore)
{
    const float face = (1 - z->lip) * (1 - z->inner_mouth) * (1 - z->socket);
    const ris_paint_cell cell = ris_paint_cells(at_size(p, 1.25f * s), 79);
    const float wide = 0.16f + 0.22f * (float)(cell.id & 255u) / 255.0f;
    const float coarse =
        fminf(1, 0.35f + 0.65f * (z->nose + z->ala + 0.8f * z->cheek + 0.5f * z->chin + 0.3f * z->forehead));
    *pore = face * coarse * (1 - 0.7f * z->scalp) * ris_paint_step(wide, 0.3f * wide, cell.near);
    const ris_paint_cell mesh = ris_paint_cells(at_size(p, 1.0f * s), 83);
    const float net = ris_paint_clamp((mesh.next - mesh.near) * 2.5f, 0, 1) - 0.6f;
    const ris_vec3 warped = vec3(
        p.x / (30 * s), p.y / (3.4f * s) + 1.2f * ris_paint_noise(at_size(p, 22 * s), 89), p.z / (30 * s));
    const float furrow = -fmaxf(0, ris_paint_noise(warped, 97) - 0.15f) * z->forehead * (1 - z->scalp);
    const float lines = ris_paint_fbm(vec3(p.x / (0.75f * s), p.y / (7 * s), p.z / (9 * s)), 2, 61);
    const float fine = ris_paint_fbm(at_size(p, 0.7f), 2, 101);
    const float crepe = ris_paint_fbm(vec3(p.x / (2.5f * s), p.y / (0.8f * s), p.z / (2.5f * s)), 2, 103);
    float height = face * (0.16f * net + 0.10f * fine) - 0.75f * *pore + 0.35f * furrow;
    height += 0.25f * crepe * fminf(1, z->under_eye + z->lid) * face - 0.55f * z->lip * fmaxf(0, lines) -
              0.1f * z->lip * fine;
    return height + 0.25f * z->scalp * fine;
}

static float oiliness(const ris_paint_zones *z, ris_vec3 p, float s)
{
    float oil = 0.35f + 0.05f * ris_paint_fbm(at_size(p, 9 * s), 3, 107) +
                0.04f * ris_paint_fbm(at_size(p, 1.6f), 2, 109);
    oil += 0.14f * z->nose + 0.10f * z->ala + 0.08f * z->forehead + 0.06f * z->chin - 0.05f * z->cheek -
           0.05f * z->neck;
    oil -= 0.12f * z->scalp;
    oil = ris_paint_mix(oil, 0.62f, z->lip);
    oil = ris_paint_mix(oil, 0.85f, fmaxf(z->inner_lip, fmaxf(z->inner_mouth, z->socket)));
    oil = ris_paint_mix(oil, 0.8f, fmaxf(z->caruncle, 0.8f * z->rim));
    return oil * (1 - z->nostril);
}

/* Share of light left in hollows; the loss is less in red, because light that gets there came off skin. */
static void shade(const ris_paint_site *site, const ris_paint_zones *z, float color[3])
{
    float open = ris_paint_clamp(site->occlusion * 1.06f, 0, 1);
    /* what is hidden at rest but shows when the mouth opens keeps its light */
    const float kept = fmaxf(z->inner_mouth, fmaxf(z->inner_lip, z->socket));
    open = fmaxf(open, ris_paint_mix(0.12f, 0.72f, kept));
    const float hollow = ris_paint_clamp(site->curvature, -0.25f, 0.25f) * (1 - kept) * (1 - z->ear);
    const float power[3] = {0.40f, 0.56f, 0.60f};
    for (int k = 0; k < 3; k++)
        color[k] *= powf(open, power[k]) * (1 - 0.35f * fmaxf(0, hollow) - 0.12f * fminf(0, hollow));
}

ris_paint_texel ris_paint_skin(const ris_paint_surface *surface, const ris_paint_site *site)
{
    const float s = surface->at.scale;
    const ris_paint_zones zones = ris_paint_find_zones(surface, site);
    pigment ink = {0};
    tone(&zones, &ink);
    mottle(&zones, site->p, s, &ink);
    lips(&zones, site->p, s, &ink);
    stubble(&zones, site->p, site->brow, &ink);
    float pore = 0;
    const float height = relief(&zones, site->p, s, &pore);
    ink.shade += 0.08f * pore - 0.035f * height;
    ink.blood += 0.05f * pore;
    ris_paint_texel texel;
    for (int k = 0; k < 3; k++) {
        const float absorbed =
            fmaxf(0, ink.melanin) * melanin[k] + fmaxf(0, ink.blood) * blood[k] + ink.shade;
        texel.color[k] = dermis[k] * expf(-absorbed - (k == 0 ? ink.cold : k == 1 ? 0.35f * ink.cold : 0));
    }
    shade(site, &zones, texel.color);
    texel.detail[0] = 0.5f + 0.4f * ris_paint_clamp(height, -1.2f, 1.2f);
    texel.detail[1] = oiliness(&zones, site->p, s);
    texel.detail[2] = site->thinness;
    texel.wrinkle = ris_paint_wrinkles(surface, site, &zones);
    return texel;
}
