// Lighting shared by the materials: three lamps, soft ambient, the key lamp's shadow, tone curve. Linear space throughout.
layout(binding = RIS_DRAW_BIND_COLOR) uniform sampler2D color_texture;
layout(binding = RIS_DRAW_BIND_SHADOW) uniform sampler2D shadow_texture;

float hash31(vec3 p)
{
    p = fract(p * 0.1031);
    p += dot(p, p.zyx + 31.32);
    return fract((p.x + p.y) * p.z);
}

// value noise in -1..1 with its gradient in yzw
vec4 noise3(vec3 p)
{
    vec3 i = floor(p), f = p - i;
    vec3 u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0), du = 30.0 * f * f * (f * (f - 2.0) + 1.0);
    float a = hash31(i), b = hash31(i + vec3(1, 0, 0)), c = hash31(i + vec3(0, 1, 0)), d = hash31(i + vec3(1, 1, 0));
    float e = hash31(i + vec3(0, 0, 1)), f0 = hash31(i + vec3(1, 0, 1)), g = hash31(i + vec3(0, 1, 1));
    float h = hash31(i + vec3(1, 1, 1));
    float k1 = b - a, k2 = c - a, k3 = e - a, k4 = a - b - c + d, k5 = a - c - e + g, k6 = a - b - e + f0;
    float k7 = -a + b + c - d + e - f0 - g + h;
    float value = a + k1 * u.x + k2 * u.y + k3 * u.z + k4 * u.x * u.y + k5 * u.y * u.z + k6 * u.z * u.x + k7 * u.x * u.y * u.z;
    vec3 slope = du * vec3(k1 + k4 * u.y + k6 * u.z + k7 * u.y * u.z, k2 + k5 * u.z + k4 * u.x + k7 * u.z * u.x,
                           k3 + k6 * u.x + k5 * u.y + k7 * u.x * u.y);
    return vec4(2.0 * value - 1.0, 2.0 * slope);
}

// share of the key lamp that reaches a point: 16 soft-edged depth comparisons
float key_shadow(vec3 world, vec3 normal)
{
    float slope = 1.0 - clamp(dot(normal, view.light[0].xyz), 0.0, 1.0);
    vec3 lifted = world + normal * (0.6 + 1.6 * slope);
    vec4 p = rows(view.shadow[0], view.shadow[1], view.shadow[2], view.shadow[3], vec4(lifted, 1.0));
    vec2 uv = p.xy * 0.5 + 0.5;
    if (any(lessThan(uv, vec2(0.01))) || any(greaterThan(uv, vec2(0.99)))) {
        return 1.0;
    }
    float texel = 1.0 / view.size.z, seen = 0.0;
    for (int k = 0; k < 4; k++) {
        vec2 offset = vec2((k & 1) == 0 ? -1.0 : 1.0, (k & 2) == 0 ? -1.0 : 1.0) * texel * 1.5;
        vec4 depth = textureGather(shadow_texture, uv + offset);
        vec2 f = fract((uv + offset) * view.size.z - 0.5);
        vec4 lit = vec4(greaterThanEqual(depth, vec4(p.z - 0.0015)));
        seen += mix(mix(lit.w, lit.z, f.x), mix(lit.x, lit.y, f.x), f.y);
    }
    return seen * 0.25;
}

float ggx(float ndh, float rough)
{
    float a = rough * rough, a2 = a * a, d = ndh * ndh * (a2 - 1.0) + 1.0;
    return a2 / (3.14159265 * d * d);
}

// GGX, Smith visibility (Schlick form), Schlick Fresnel; times n.l
float specular(vec3 n, vec3 v, vec3 l, float rough, float f0)
{
    vec3 h = normalize(v + l);
    float ndl = clamp(dot(n, l), 0.0, 1.0), ndv = clamp(dot(n, v), 0.001, 1.0);
    float k = (rough + 1.0) * (rough + 1.0) * 0.125;
    float visibility = 0.25 / ((ndl * (1.0 - k) + k) * (ndv * (1.0 - k) + k));
    float fresnel = f0 + (1.0 - f0) * pow(1.0 - clamp(dot(h, v), 0.0, 1.0), 5.0);
    return ggx(clamp(dot(n, h), 0.0, 1.0), rough) * visibility * fresnel * ndl;
}

// light that wraps around the edge by w, energy kept
vec3 wrapped(float ndl, vec3 w)
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
    c *= 0.80;
    return clamp((c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0);
}

vec3 base_color(vec2 uv)
{
    return object.tint.w > 0.5 ? texture(color_texture, uv).rgb : object.tint.rgb;
}
