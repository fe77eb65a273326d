#include "examples/games/frame/gl_picture.h"

#include "examples/games/frame/gl_shaders.h"
#include "examples/games/frame/gl_shapes.h"
#include "plugin/graphics/cairo_picture.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <tuple>

namespace supercircle::frame {

namespace {

constexpr std::size_t kMostTexts = 512; ///< textures that are kept, a few kB each

GLuint shader(GLenum kind, const std::string& text, std::string& error) {
    const GLuint s = glCreateShader(kind);
    const char* const source = text.c_str();
    glShaderSource(s, 1, &source, nullptr);
    glCompileShader(s);
    GLint good = 0;
    glGetShaderiv(s, GL_COMPILE_STATUS, &good);
    char log[512] = "";
    if (good == GL_FALSE)
        glGetShaderInfoLog(s, sizeof log, nullptr, log);
    error += log;
    return s;
}

GLuint program(const char* vertex, const char* fragment, std::string& error) {
    const GLuint p = glCreateProgram();
    const GLuint v = shader(GL_VERTEX_SHADER, std::string(kPlace) + vertex, error);
    const GLuint f = shader(GL_FRAGMENT_SHADER, fragment, error);
    glAttachShader(p, v);
    glAttachShader(p, f);
    glLinkProgram(p);
    glDeleteShader(v);
    glDeleteShader(f);
    GLint good = 0;
    glGetProgramiv(p, GL_LINK_STATUS, &good);
    if (good == GL_FALSE && error.empty())
        error = "its shaders cannot be linked";
    return p;
}

void attribute(GLuint index, GLint count, GLenum type, std::size_t stride, std::size_t offset, GLuint divisor) {
    glEnableVertexAttribArray(index);
    glVertexAttribPointer(index, count, type, type == GL_FLOAT ? GL_FALSE : GL_TRUE, static_cast<GLsizei>(stride),
                          reinterpret_cast<const void*>(offset));
    glVertexAttribDivisor(index, divisor);
}

GLuint texture(GLenum inner, GLenum outer, GLenum type, int width, int height, int row, const void* data) {
    GLuint name = 0;
    glGenTextures(1, &name);
    glBindTexture(GL_TEXTURE_2D, name);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, row);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(inner), width, height, 0, outer, type, data);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTexParameteri(GL_TEXTURE_2D, filter, GL_NEAREST);
    return name;
}

struct Written {
    GLuint texture = 0;
    graphics::TextCoverage coverage;
};

} // namespace

struct GlPicture::Impl {
    GLuint pieces = 0, triangles = 0, box = 0;
    GLuint arrays[3] = {}, buffers[2] = {};
    std::map<std::tuple<std::string, double, bool>, Written> texts;

    void use(GLuint program, GLuint array, int width, int height) const {
        glUseProgram(program);
        glBindVertexArray(array);
        glUniform2f(glGetUniformLocation(program, "size"), static_cast<float>(width), static_cast<float>(height));
    }
    void forgetTexts() {
        for (const auto& entry : texts)
            glDeleteTextures(1, &entry.second.texture);
        texts.clear();
    }
    void text(const GlText& t);
    void set(const char* name, double a, double b, double c, double d) const {
        glUniform4f(glGetUniformLocation(box, name), static_cast<float>(a), static_cast<float>(b),
                    static_cast<float>(c), static_cast<float>(d));
    }
    void rectangle(double x, double y, double width, double height) const {
        set("box", x, y, width, height);
        glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    }
};

void GlPicture::Impl::text(const GlText& t) {
    Written& w = texts[{t.text, t.size, t.bold}];
    if (w.texture == 0) {
        w.coverage = graphics::textCoverage(t.text, t.size, t.bold);
        w.texture =
            texture(GL_R8, GL_RED, GL_UNSIGNED_BYTE, w.coverage.width, w.coverage.height, 0, w.coverage.alpha.data());
        w.coverage.alpha = {};
    }
    glBindTexture(GL_TEXTURE_2D, w.texture);
    glUniform1i(glGetUniformLocation(box, "coverage"), 1);
    set("colour", t.colour.r, t.colour.g, t.colour.b, t.colour.a);
    const double turn = t.angle * std::numbers::pi / 180.0, x = std::round(-0.5 * t.anchor * w.coverage.advance);
    set("pivot", std::round(t.at.x), std::round(t.at.y), std::cos(turn), std::sin(turn));
    rectangle(x + w.coverage.left, w.coverage.top, w.coverage.width, w.coverage.height);
}

GlPicture::GlPicture() : impl_(std::make_unique<Impl>()) {}

GlPicture::~GlPicture() {
    Impl& s = *impl_;
    if (s.pieces == 0)
        return;
    s.forgetTexts();
    glDeleteBuffers(2, s.buffers);
    glDeleteVertexArrays(3, s.arrays);
    for (const GLuint p : {s.pieces, s.triangles, s.box})
        glDeleteProgram(p);
}

std::string GlPicture::open() {
    Impl& s = *impl_;
    std::string error;
    s.pieces = program(kPieceVertex, kPieceFragment, error);
    s.triangles = program(kTriangleVertex, kTriangleFragment, error);
    s.box = program(kBoxVertex, kBoxFragment, error);
    glGenVertexArrays(3, s.arrays);
    glGenBuffers(2, s.buffers);
    glBindVertexArray(s.arrays[1]);
    glBindBuffer(GL_ARRAY_BUFFER, s.buffers[1]);
    attribute(0, 2, GL_FLOAT, sizeof(GlCorner), offsetof(GlCorner, at), 0);
    attribute(1, 4, GL_UNSIGNED_BYTE, sizeof(GlCorner), offsetof(GlCorner, colour), 0);
    return error;
}

void GlPicture::draw(const picture::DrawList& list, int width, int height) {
    Impl& s = *impl_;
    const GlShapes shapes = shapesOf(list);
    const auto load = [](GLuint buffer, const auto& items) {
        glBindBuffer(GL_ARRAY_BUFFER, buffer);
        glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(items.size() * sizeof items[0]), items.data(),
                     GL_STREAM_DRAW);
    };
    load(s.buffers[1], shapes.corners);
    load(s.buffers[0], shapes.pieces);
    if (s.texts.size() > kMostTexts)
        s.forgetTexts();
    glViewport(0, 0, width, height);
    glDisable(GL_SCISSOR_TEST);
    glClear(GL_COLOR_BUFFER_BIT);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA); // colours are multiplied by alpha; a glow has none and adds
    for (const GlBatch& batch : shapes.batches) {
        const auto count = static_cast<GLsizei>(batch.count);
        if (batch.kind == GlBatch::Kind::Pieces) {
            s.use(s.pieces, s.arrays[0], width, height);
            const std::size_t from = batch.first * sizeof(GlPiece), size = sizeof(GlPiece);
            attribute(0, 4, GL_FLOAT, size, from + offsetof(GlPiece, a), 1);
            attribute(1, 2, GL_FLOAT, size, from + offsetof(GlPiece, radii), 1);
            attribute(2, 4, GL_FLOAT, size, from + offsetof(GlPiece, cutA), 1);
            attribute(3, 4, GL_UNSIGNED_BYTE, size, from + offsetof(GlPiece, colour), 1);
            attribute(4, 1, GL_FLOAT, size, from + offsetof(GlPiece, glow), 1);
            glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count);
        } else if (batch.kind == GlBatch::Kind::Triangles) {
            s.use(s.triangles, s.arrays[1], width, height);
            glDrawArrays(GL_TRIANGLES, static_cast<GLint>(batch.first), count);
        } else if (batch.kind == GlBatch::Kind::Text) {
            s.use(s.box, s.arrays[2], width, height);
            for (std::size_t i = 0; i < batch.count; ++i)
                s.text(shapes.texts[batch.first + i]);
        } else {
            glEnable(GL_SCISSOR_TEST);
            const auto px = [](double v) { return static_cast<GLint>(std::lround(v)); };
            const GLint left = px(batch.clip.x), top = px(batch.clip.y);
            glScissor(left, height - px(batch.clip.bottom()), px(batch.clip.right()) - left,
                      px(batch.clip.bottom()) - top);
        }
    }
    glDisable(GL_SCISSOR_TEST);
}

void GlPicture::drawOver(const graphics::CairoCanvas& canvas, int width, int height) {
    Impl& s = *impl_;
    const graphics::CairoCanvas::Pixels p = canvas.pixels();
    s.use(s.box, s.arrays[2], width, height);
    const GLuint name =
        texture(GL_RGBA8, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, p.width, p.height, p.stride / 4, p.data);
    glUniform1i(glGetUniformLocation(s.box, "coverage"), 0);
    s.set("pivot", 0.0, 0.0, 1.0, 0.0);
    s.rectangle(0.0, 0.0, p.width, p.height);
    glDeleteTextures(1, &name);
}

} // namespace supercircle::frame
