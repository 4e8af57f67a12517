#include "tests/support/gl_shader.h"

#ifdef KOKAGE_TESTS_GL

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdexcept>

namespace kokage::test {
namespace {

class EglContext final : public GlContext {
  public:
    EglContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {
        glGenVertexArrays(1, &vertices_);
        glBindVertexArray(vertices_);
    }
    ~EglContext() override {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
        eglTerminate(display_);
    }

    std::string renderer() const override { return reinterpret_cast<const char*>(glGetString(GL_RENDERER)); }

    int texture(Format format, int width, int height, const void* texels) override {
        GLuint name = 0;
        glGenTextures(1, &name);
        glActiveTexture(GL_TEXTURE0 + GLenum(units_));
        glBindTexture(GL_TEXTURE_2D, name);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        switch (format) {
        case Format::r32f:
            glTexImage2D(GL_TEXTURE_2D, 0, GL_R32F, width, height, 0, GL_RED, GL_FLOAT, texels);
            break;
        case Format::rgba32f:
            glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, texels);
            break;
        case Format::rgba16ui:
            glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16UI, width, height, 0, GL_RGBA_INTEGER, GL_UNSIGNED_SHORT, texels);
            break;
        case Format::rgba32ui:
            glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32UI, width, height, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, texels);
            break;
        }
        textures_.push_back(name);
        return units_++;
    }

    void forget_textures() override {
        glDeleteTextures(GLsizei(textures_.size()), textures_.data());
        textures_.clear();
        units_ = 0;
    }

    void use(const std::string& source, int targets, Language language) override {
        targets_ = targets;
        const std::string version = language == Language::glsl_330 ? "#version 330 core\n" : "#version 300 es\n";
        program_ = glCreateProgram();
        compile(GL_VERTEX_SHADER, version + "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, "
                                            "gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }");
        compile(GL_FRAGMENT_SHADER, version + source);
        glLinkProgram(program_);
        GLint linked = 0;
        glGetProgramiv(program_, GL_LINK_STATUS, &linked);
        if (!linked) {
            char log[4096] = "";
            glGetProgramInfoLog(program_, sizeof log, nullptr, log);
            throw std::runtime_error(log);
        }
        glUseProgram(program_);
    }

    void set(const char* uniform, int value) override { glUniform1i(at(uniform), value); }
    void set(const char* uniform, const glm::ivec4& v) override { glUniform4i(at(uniform), v.x, v.y, v.z, v.w); }
    void set(const char* uniform, const std::vector<glm::ivec2>& values) override {
        glUniform2iv(at(uniform), GLsizei(values.size()), &values[0].x);
    }
    void set(const char* uniform, float value) override { glUniform1f(at(uniform), value); }
    void set(const char* uniform, const glm::vec3& v) override { glUniform3f(at(uniform), v.x, v.y, v.z); }

    std::vector<std::vector<glm::vec4>> draw(int width, int height) override {
        GLuint buffer = 0;
        glGenFramebuffers(1, &buffer);
        glBindFramebuffer(GL_FRAMEBUFFER, buffer);
        std::vector<GLuint> targets(static_cast<std::size_t>(targets_));
        std::vector<GLenum> attachments;
        glGenTextures(targets_, targets.data());
        glActiveTexture(GL_TEXTURE0 + GLenum(units_));
        for (GLuint target : targets) {
            glBindTexture(GL_TEXTURE_2D, target);
            glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, nullptr);
            attachments.push_back(GL_COLOR_ATTACHMENT0 + GLenum(attachments.size()));
            glFramebufferTexture2D(GL_FRAMEBUFFER, attachments.back(), GL_TEXTURE_2D, target, 0);
        }
        glDrawBuffers(targets_, attachments.data());
        if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
            throw std::runtime_error("no framebuffer of floats");
        glViewport(0, 0, width, height);
        glDrawArrays(GL_TRIANGLES, 0, 3);
        std::vector<std::vector<glm::vec4>> values;
        for (const GLenum attachment : attachments) {
            values.emplace_back(std::size_t(width) * std::size_t(height));
            glReadBuffer(attachment);
            glReadPixels(0, 0, width, height, GL_RGBA, GL_FLOAT, values.back().data());
        }
        glDeleteTextures(targets_, targets.data());
        glDeleteFramebuffers(1, &buffer);
        if (const GLenum error = glGetError(); error != GL_NO_ERROR)
            throw std::runtime_error("OpenGL's error " + std::to_string(error));
        return values;
    }

  private:
    GLint at(const char* uniform) const { return glGetUniformLocation(program_, uniform); }

    void compile(GLenum kind, const std::string& source) const {
        const GLuint shader = glCreateShader(kind);
        const char* text = source.c_str();
        glShaderSource(shader, 1, &text, nullptr);
        glCompileShader(shader);
        GLint compiled = 0;
        glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
        if (!compiled) {
            char log[4096] = "";
            glGetShaderInfoLog(shader, sizeof log, nullptr, log);
            throw std::runtime_error(log);
        }
        glAttachShader(program_, shader);
    }

    EGLDisplay display_;
    EGLContext context_;
    GLuint vertices_ = 0, program_ = 0;
    std::vector<GLuint> textures_;
    int units_ = 0, targets_ = 0;
};

} // namespace

std::unique_ptr<GlContext> GlContext::make(std::string& why) {
    why = "EGL has no surfaceless platform with OpenGL (package libgl1-mesa-dri)";
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        return nullptr;
    const EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API))
        return nullptr;
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
    const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        eglTerminate(display);
        return nullptr;
    }
    return std::make_unique<EglContext>(display, context);
}

} // namespace kokage::test

#else

namespace kokage::test {

std::unique_ptr<GlContext> GlContext::make(std::string& why) {
    why = "built without OpenGL (packages libepoxy-dev and libegl-dev)";
    return nullptr;
}

} // namespace kokage::test

#endif
