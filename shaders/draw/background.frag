// Neutral grey studio paper, lit from behind the head; a little noise against banding.
#version 460
layout(location = 0) in vec2 in_place;
layout(location = 0) out vec4 out_color;

void main()
{
    float glow = exp(-dot(in_place * vec2(0.75, 0.8) - vec2(0.0, -0.1), in_place * vec2(0.75, 0.8) - vec2(0.0, -0.1)) * 0.9);
    float grey = mix(0.035, 0.17, glow);
    float noise = fract(sin(dot(gl_FragCoord.xy, vec2(12.9898, 78.233))) * 43758.547) - 0.5;
    out_color = vec4(vec3(0.97, 1.0, 1.03) * grey + noise * 0.0035, 1.0);
}
