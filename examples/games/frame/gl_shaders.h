#pragma once
// Shaders of gl_picture.cpp. Colours leave them multiplied by alpha.

namespace supercircle::frame {

/// Pixels with y downwards to the clip space.
inline constexpr const char* kPlace = R"(#version 330 core
uniform vec2 size;
vec4 place(vec2 p) { return vec4(2.0 * p.x / size.x - 1.0, 1.0 - 2.0 * p.y / size.y, 0.0, 1.0); }
)";
inline constexpr const char* kPieceVertex = R"(
layout(location = 0) in vec4 ends; layout(location = 1) in vec2 radii; layout(location = 2) in vec4 cuts;
layout(location = 3) in vec4 colour; layout(location = 4) in float glow;
flat out vec4 e; flat out vec2 r; flat out vec4 k; flat out vec4 c; flat out float light; out vec2 p;
// How far the piece reaches beyond its end: round, or up to the corner of a cut.
float beyond(vec2 cut, vec2 along, float far) {
    if (dot(cut, cut) < 1e-6) return far;
    float c = dot(normalize(cut), along);
    return far * sqrt(max(1.0 - c * c, 0.0)) / max(c, 0.1) + 0.5;
}
void main() {
    vec2 along = ends.zw - ends.xy;
    float far = max(radii.x, radii.y) + 1.0, len = length(along);
    along = len > 1e-5 ? along / len : vec2(1.0, 0.0);
    vec2 side = vec2(-along.y, along.x);
    p = (gl_VertexID & 1) == 0 ? ends.xy - beyond(cuts.xy, along, far) * along
                               : ends.zw + beyond(cuts.zw, along, far) * along;
    p += ((gl_VertexID & 2) == 0 ? -far : far) * side;
    e = ends; r = radii; k = cuts; c = colour; light = glow;
    gl_Position = place(p);
})";
inline constexpr const char* kPieceFragment = R"(#version 330 core
flat in vec4 e; flat in vec2 r; flat in vec4 k; flat in vec4 c; flat in float light; in vec2 p;
out vec4 o;
void main() {
    vec2 d = p - e.xy, ab = e.zw - e.xy;
    if (light > 0.5) {
        float t = 1.0 - min(dot(d, d) / max(r.x * r.x, 1e-6), 1.0);
        o = vec4(c.rgb * (c.a * t * t), 0.0);
        return;
    }
    if (dot(d, k.xy) < 0.0 || dot(p - e.zw, k.zw) > 0.0) discard;
    float t = clamp(dot(d, ab) / max(dot(ab, ab), 1e-9), 0.0, 1.0), half_width = mix(r.x, r.y, t);
    float cover = clamp(0.5 + half_width - length(d - t * ab), 0.0, 1.0) * min(2.0 * half_width, 1.0) * c.a;
    o = vec4(c.rgb * cover, cover);
})";
inline constexpr const char* kTriangleVertex = R"(
layout(location = 0) in vec2 at; layout(location = 1) in vec4 colour;
out vec4 c;
void main() { c = vec4(colour.rgb * colour.a, colour.a); gl_Position = place(at); })";
inline constexpr const char* kTriangleFragment = R"(#version 330 core
in vec4 c; out vec4 o;
void main() { o = c; })";
inline constexpr const char* kBoxVertex = R"(
uniform vec4 box, pivot; // pivot: place, cosine and sine of the angle
out vec2 uv;
void main() {
    uv = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    vec2 p = box.xy + uv * box.zw;
    gl_Position = place(pivot.xy + mat2(pivot.zw, -pivot.w, pivot.z) * p);
})";
inline constexpr const char* kBoxFragment = R"(#version 330 core
uniform sampler2D image; uniform vec4 colour; uniform bool coverage;
in vec2 uv; out vec4 o;
void main() {
    vec4 t = texture(image, uv);
    o = coverage ? vec4(colour.rgb * colour.a, colour.a) * t.r : t;
})";

} // namespace supercircle::frame
