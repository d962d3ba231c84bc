// One triangle over the whole picture.
#version 460
layout(location = 0) out vec2 out_place;

void main()
{
    vec2 p = vec2(float((gl_VertexIndex << 1) & 2), float(gl_VertexIndex & 2));
    out_place = p * 2.0 - 1.0;
    gl_Position = vec4(out_place, 0.0, 1.0);
}
