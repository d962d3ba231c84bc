// Lighting shared by the materials: three lamps, soft ambient, the key lamp's shadow, tone curve. Linear space throughout.
layout(binding = RIS_DRAW_BIND_COLOR) uniform sampler2D color_texture;
layout(binding = RIS_DRAW_BIND_DETAIL) uniform sampler2D detail_texture;
layout(binding = RIS_DRAW_BIND_WRINKLE) uniform sampler2D wrinkle_texture;
layout(binding = RIS_DRAW_BIND_SHADOW) uniform sampler2D shadow_texture;

// share of the key lamp that reaches a point: sixteen soft-edged depth comparisons
float key_shadow(vec3 world, vec3 normal)
{
    float slope = 1.0 - clamp(dot(normal, view.light[0].xyz), 0.0, 1.0);
    vec3 lifted = world + normal * (0.9 + 2.6 * slope);
    vec4 p = rows(view.shadow[0], view.shadow[1], view.shadow[2], view.shadow[3], vec4(lifted, 1.0));
    vec2 uv = p.xy * 0.5 + 0.5;
    if (any(lessThan(uv, vec2(0.01))) || any(greaterThan(uv, vec2(0.99)))) {
        return 1.0;
    }
    float texel = 1.0 / view.size.z, seen = 0.0;
    for (int k = 0; k < 4; k++) {
        vec2 at = uv + texel * vec2((k & 1) == 0 ? -0.9 : 0.9, (k & 2) == 0 ? -0.9 : 0.9);
        vec4 depth = textureGather(shadow_texture, at);
        vec2 f = fract(at * view.size.z - 0.5);
        vec4 lit = clamp((depth - p.z + 0.004) * 400.0, 0.0, 1.0);
        seen += mix(mix(lit.w, lit.z, f.x), mix(lit.x, lit.y, f.x), f.y);
    }
    return seen * 0.25;
}

float fifth(float x)
{
    return x * x * x * x * x;
}

// GGX with Smith visibility (Schlick form) and Schlick Fresnel, times n.l: two lobes of one surface, share and roughness
// factor of the sharper one given
float specular2(vec3 n, vec3 v, vec3 l, float rough, float f0, float share, float factor)
{
    vec3 h = normalize(v + l);
    float ndl = clamp(dot(n, l), 0.0, 1.0), ndv = clamp(dot(n, v), 0.001, 1.0), ndh = clamp(dot(n, h), 0.0, 1.0);
    float k = (rough + 1.0) * (rough + 1.0) * 0.125;
    float common_part = 0.25 * ndl * (f0 + (1.0 - f0) * fifth(1.0 - clamp(dot(h, v), 0.0, 1.0))) /
                        ((ndl * (1.0 - k) + k) * (ndv * (1.0 - k) + k));
    float a = rough * rough, b = a * factor * factor, a2 = a * a, b2 = b * b;
    float da = ndh * ndh * (a2 - 1.0) + 1.0, db = ndh * ndh * (b2 - 1.0) + 1.0;
    return common_part * ((1.0 - share) * a2 / (da * da) + share * b2 / (db * db)) * 0.31830989;
}

float specular(vec3 n, vec3 v, vec3 l, float rough, float f0)
{
    return specular2(n, v, l, rough, f0, 0.0, 1.0);
}

// light that wraps around the edge by w, energy kept
vec3 wrapped(vec3 ndl, vec3 w)
{
    return max(vec3(0.0), (ndl + w) / ((1.0 + w) * (1.0 + w)));
}

vec3 ambient(vec3 n)
{
    return mix(view.ground.rgb, view.sky.rgb, 0.5 + 0.5 * n.y);
}

// the studio as a mirror sees it: paper, and the soft boxes of the lamps
vec3 studio(vec3 r)
{
    vec3 color = mix(view.ground.rgb, view.sky.rgb, smoothstep(-0.5, 0.7, r.y)) * 0.9;
    for (int k = 0; k < 3; k++) {
        vec3 l = view.light[k].xyz;
        vec3 x = normalize(cross(vec3(0.0, 1.0, 0.0), l)), y = cross(l, x);
        vec2 at = vec2(dot(r, x), dot(r, y)) / max(dot(r, l), 0.05) / view.light[k].w;
        float box = smoothstep(1.15, 0.85, abs(at.x)) * smoothstep(1.15, 0.85, abs(at.y)) * step(0.05, dot(r, l));
        color += view.radiance[k].rgb * box * 1.6;
    }
    return color;
}

// a filmic shoulder (Narkowicz's fit of the ACES curve), less contrast
vec3 tone(vec3 c)
{
    c *= 0.64;
    return clamp((c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0);
}

// textures hold sRGB values unconverted (conversion of every texel is slow on software devices)
vec3 linear(vec3 c)
{
    return c * (c * (c * 0.305306011 + 0.682171111) + 0.012522878);
}

// studio paper behind the head, brighter in the middle, with a little noise against banding
vec3 backdrop(vec2 pixel)
{
    if (view.paper > 0.0) {
        return vec3(1.0, 0.985, 0.95) * view.paper;
    }
    vec2 at = (pixel / view.size.xy * 2.0 - 1.0) * vec2(0.75, 0.8) - vec2(0.0, -0.1);
    float grey = mix(0.035, 0.17, exp(-dot(at, at) * 0.9));
    float noise = fract(sin(dot(pixel, vec2(12.9898, 78.233))) * 43758.547) - 0.5;
    return vec3(0.97, 1.0, 1.03) * grey + noise * 0.0035;
}

// the lower end of a bust melts into the backdrop
vec3 melt(vec3 color, float height)
{
    if (view.fade[0] >= view.fade[1] || height > view.fade[1]) {
        return color;
    }
    return mix(backdrop(gl_FragCoord.xy), color, smoothstep(view.fade[0], view.fade[1], height));
}

vec3 base_color(vec2 uv)
{
    return object.tint.w > 0.5 ? linear(texture(color_texture, uv).rgb) : object.tint.rgb;
}
