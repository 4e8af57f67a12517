#pragma once
// What tests of relief's shaders share.
#include "reflection/relief/relief_textures.h"
#include "tests/support/gl_shader.h"

#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

namespace kokage::test {

/// Pixels a row: one ray each.
inline constexpr int kRaysARow = 160;

inline std::string source_of(const std::string& name) {
    std::ifstream file(std::string(KOKAGE_TESTS_FOLDER) + "/../reflection/relief/" + name);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

class ReliefShader : public testing::Test {
  protected:
    void SetUp() override {
        std::string why;
        gl_ = GlContext::make(why);
        if (!gl_)
            GTEST_SKIP() << "skipped: no OpenGL: " << why;
    }
    void set_relief(const HeightField& field, int depths, int planes, const ReliefTextures& textures) const {
        ASSERT_GT(field.width, 0);
        gl_->set("reliefDepths", depths);
        gl_->set("reliefPlanes", planes);
        gl_->set("reliefSize", textures.size);
        gl_->set("reliefLevels", std::vector<glm::ivec2>(textures.levels.begin(), textures.levels.end()));
    }
    int upload(const DataTexture<float>& t) const {
        return gl_->texture(GlContext::Format::r32f, t.width, t.height, t.texels.data());
    }
    int upload(const DataTexture<std::array<std::uint16_t, 4>>& t) const {
        return gl_->texture(GlContext::Format::rgba16ui, t.width, t.height, t.texels.data());
    }
    int upload(const DataTexture<glm::vec4>& t) const {
        return gl_->texture(GlContext::Format::rgba32f, t.width, t.height, t.texels.data());
    }
    int upload(const DataTexture<glm::uvec4>& t) const {
        return gl_->texture(GlContext::Format::rgba32ui, t.width, t.height, t.texels.data());
    }
    int upload(const std::vector<glm::vec4>& texels) const {
        return gl_->texture(GlContext::Format::rgba32f, kRaysARow, int(texels.size()) / kRaysARow, texels.data());
    }

    std::unique_ptr<GlContext> gl_;
};

} // namespace kokage::test
