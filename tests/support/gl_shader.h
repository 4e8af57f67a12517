#pragma once
// OpenGL without a window, for tests of our shaders: EGL's surfaceless platform (Mesa draws in software where there is
// no GPU). A fragment shader runs once for each of a row of results, and reads its input from textures.
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

namespace kokage::test {

class GlContext {
  public:
    /// Null where there is no OpenGL 3.3 to be had; `why` then tells what is missing.
    static std::unique_ptr<GlContext> make(std::string& why);
    virtual ~GlContext() = default;

    virtual std::string renderer() const = 0;

    enum class Format { r32f, rgba32f, rgba16ui, rgba32ui };
    /// Uploads texels, row by row, without filter and mips; the texture is bound to the unit that is returned.
    virtual int texture(Format format, int width, int height, const void* texels) = 0;
    /// Units are few: all textures so far go, and units count from 0 again.
    virtual void forget_textures() = 0;

    enum class Language { glsl_330, glsl_es_300 };
    /// Compiles a fragment shader (`source`, without #version) whose outputs are `targets` vec4s at locations 0, 1, ...
    /// Throws std::runtime_error with the compiler's words.
    virtual void use(const std::string& source, int targets, Language language = Language::glsl_330) = 0;
    virtual void set(const char* uniform, int value) = 0;
    virtual void set(const char* uniform, const glm::ivec4& value) = 0;
    virtual void set(const char* uniform, const std::vector<glm::ivec2>& values) = 0;
    virtual void set(const char* uniform, float value) = 0;
    virtual void set(const char* uniform, const glm::vec3& value) = 0;
    /// Draws width x height pixels; the targets' values, each row by row from gl_FragCoord.y = 0.5 on.
    virtual std::vector<std::vector<glm::vec4>> draw(int width, int height) = 0;
};

} // namespace kokage::test
