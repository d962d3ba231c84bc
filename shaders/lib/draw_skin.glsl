layout(location = 0) in vec3 in_world;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec2 in_uv;
layout(location = 3) in vec4 in_rest;
layout(location = 4) in vec3 in_squeeze_own;
layout(location = 5) in vec3 in_squeeze_mixed;
layout(location = 0) out vec4 out_color;

// how far skin that is shorter by a share has folded
float folded(float shorter)
{
    return smoothstep(RIS_DRAW_FOLD_FROM, RIS_DRAW_FOLD_FULL, shorter);
}

// share by which the skin is shorter now along a direction (world, any length)
float shorter_along(vec3 direction)
{
    vec3 g = direction.x * object.place[0].xyz + direction.y * object.place[1].xyz + direction.z * object.place[2].xyz;
    float square = dot(in_squeeze_own, g * g) + 2.0 * dot(in_squeeze_mixed, g * g.yzx), own = dot(g, g);
    return own > 0.0 ? 1.0 - sqrt(own / max(square, 1e-3 * own)) : 0.0;
}

// Colour of the skin: light that bleeds into the shadow edge (red farthest), two specular lobes broken up by pores,
// ambient that keeps red in the creases.
vec3 skin_color()
{
    vec3 smooth_n = normalize(in_normal), v = normalize(view.eye.xyz - in_world);
    vec3 albedo = base_color(in_uv);
    float ao = clamp(in_rest.w, 0.0, 1.0);

    // relief of the detail texture, by differences over the pixel (Mikkelsen 2010); mip levels flatten it far away
    vec3 detail = texture(detail_texture, in_uv).rgb;
    vec3 along_x = dFdx(in_world), along_y = dFdy(in_world);
    vec3 across_x = cross(along_y, smooth_n), across_y = cross(smooth_n, along_x);
    float area = dot(along_x, across_x);
    vec3 slope = object.pivot.w * sign(area) * (dFdx(detail.r) * across_x + dFdy(detail.r) * across_y);

    // wrinkles: furrows open where the skin is squeezed across them
    float height = texture(wrinkle_texture, in_uv).r;
    vec3 across_fold = sign(area) * (dFdx(height) * across_x + dFdy(height) * across_y);
    float fold = folded(shorter_along(across_fold));
    vec3 fold_slope = RIS_DRAW_WRINKLE_MM * fold * across_fold;
    // at the bottom of a furrow the slope has no direction: the sum of both
    float squeezed = folded(1.0 - inversesqrt(max(in_squeeze_own.x + in_squeeze_own.y + in_squeeze_own.z - 1.0, 1.0)));
    float furrow = squeezed * clamp((RIS_DRAW_WRINKLE_FLAT - height) / 0.6, 0.0, 1.0);
    ao *= 1.0 - 0.4 * furrow;

    vec3 n = normalize(abs(area) * smooth_n - slope - fold_slope);
    vec3 soft = normalize(mix(normalize(abs(area) * smooth_n - 0.8 * fold_slope), n, 0.4));

    float rough = 0.72 - 0.45 * detail.g;
    float thin = detail.b;
    float gloss = ao * ao;

    vec3 spread = vec3(0.32, 0.12, 0.07) + thin * vec3(0.45, 0.12, 0.06);
    // creases keep some red: light scatters in from their walls
    vec3 open = ao * (vec3(1.35, 0.95, 0.85) - ao * vec3(0.35, -0.05, -0.15)) + (1.0 - ao) * vec3(0.15, 0.05, 0.045);
    float lit = key_shadow(in_world, smooth_n) * (1.0 - 0.35 * furrow); // its walls keep the lamp out
    vec3 diffuse = ambient(soft) * open, shine = vec3(0.0);
    for (int k = 0; k < 3; k++) {
        vec3 l = view.light[k].xyz;
        // the shadow's edge is red too
        vec3 through = k == 0 ? lit * (vec3(1.5, 0.95, 0.8) - lit * vec3(0.5, -0.05, -0.2)) : open;
        float bare = dot(n, l), deep = dot(soft, l);
        diffuse += view.radiance[k].rgb * wrapped(deep * vec3(1.0, 0.4, 0.0) + bare * vec3(0.0, 0.6, 1.0), spread) * through;
        shine += view.radiance[k].rgb * (specular2(n, v, l, rough, 0.028, 0.25, 0.6) * (k == 0 ? lit : k == 1 ? ao : 0.4 * ao) * gloss);
    }
    // soft reflection of the room at grazing angles
    float grazing = fifth(1.0 - clamp(dot(n, v), 0.0, 1.0));
    vec3 room = ambient(reflect(-v, n)) * ((0.014 + 0.16 * grazing) * gloss);
    return tone(albedo * diffuse + 1.7 * shine + room);
}
