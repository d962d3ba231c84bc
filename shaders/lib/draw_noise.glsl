// Value noise, 0..1, without textures.
float hash1(float n)
{
    return fract(sin(n) * 43758.547);
}

float noise2(vec2 p)
{
    vec2 i = floor(p), f = fract(p);
    vec2 u = f * f * (3.0 - 2.0 * f);
    float n = i.x + i.y * 57.0;
    return mix(mix(hash1(n), hash1(n + 1.0), u.x), mix(hash1(n + 57.0), hash1(n + 58.0), u.x), u.y);
}

float noise3(vec3 p)
{
    float layer = floor(p.z), u = fract(p.z);
    vec2 shift = vec2(17.0, 31.0) * layer;
    return mix(noise2(p.xy + shift), noise2(p.xy + shift + vec2(17.0, 31.0)), u * u * (3.0 - 2.0 * u));
}
