// Views in parallel projection, and cards that show them.
#include "common/gltf/gltf_document.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "picture_scenes.h"
#include "reflection/impostor.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <tiny_gltf.h>

namespace kokage {
namespace {

using namespace test;

/// One upright square of 1 m in the plane z = 0, with its front to +Z.
PatchScene square() {
    PatchScene scene;
    scene.positions = {{-0.5f, 0, 0}, {0.5f, 0, 0}, {0.5f, 1, 0}, {-0.5f, 1, 0}};
    scene.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.triangle_patch = {0, 0};
    scene.patches = {{.first_triangle = 0, .triangle_count = 2, .optics = 0, .kind = PatchKind::leaf, .leaf = 0}};
    scene.optics = {{}};
    scene.leaf_count = 1;
    return scene;
}

ShadedScene lit(const PatchScene& patches, const glm::vec3& front, const glm::vec3& back) {
    ShadedScene scene = evenly_shaded(patches, front);
    scene.radiance_back.assign(patches.patches.size(), back);
    return scene;
}

TEST(CaptureView, ShowsTheSideThatLooksAtTheViewer) {
    const PatchScene patches = square();
    const ShadedScene scene = lit(patches, {1, 0, 0}, {0, 0, 1});
    const RayQueries queries(patches);
    const Environment environment = constant_environment(glm::vec3(1));
    ViewFrame frame;
    frame.centre = {0, 0.5f, 0};
    frame.half_width = frame.half_height = 1;
    for (const bool behind : {false, true}) {
        frame.towards_viewer = {0, 0, behind ? -1.f : 1.f};
        const CapturedView view = capture_view(scene, queries, environment, frame, 32, 32, 4, silent_progress());
        EXPECT_NEAR(coverage(view.alpha), 0.25, 1e-6) << "1 m2 of 4";
        EXPECT_EQ(pixel(view.color, 16, 16), behind ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0));
        EXPECT_EQ(pixel(view.color, 0, 0), pixel(view.color, 16, 16)) << "empty texels take their neighbours' colour";
        EXPECT_NEAR(pixel(view.normal, 16, 16).z, behind ? -1 : 1, 1e-5) << "of the seen side";
        EXPECT_EQ(view.alpha.at(0, 0)[0], 0.f);
        EXPECT_EQ(view.alpha.at(16, 16)[0], 1.f);
    }
    EXPECT_THROW(capture_view(scene, queries, environment, frame, 0, 32, 4, silent_progress()), InputError);
}

TEST(CaptureView, IsTheSameForAnyNumberOfThreads) {
    const PatchScene patches = random_crown(200, 3, Optics{});
    const ShadedScene scene = evenly_shaded(patches, glm::vec3(0.5f));
    const RayQueries queries(patches);
    const Environment environment = constant_environment(glm::vec3(1));
    std::vector<std::vector<float>> alphas;
    for (const int threads : {1, 3}) {
        set_thread_count(threads);
        alphas.push_back(
            capture_view(scene, queries, environment, frame_of(patches, 0.3f), 40, 50, 3, silent_progress())
                .alpha.pixels);
    }
    set_thread_count(0);
    EXPECT_EQ(alphas[0], alphas[1]);
}

TEST(Impostor, FacesShowTheSceneFromTheirSide) {
    const PatchScene patches = random_crown(400, 5, Optics{});
    ShadedScene scene = evenly_shaded(patches, glm::vec3(0.5f, 0.25f, 0.75f));
    const RayQueries queries(patches);
    const Environment environment = constant_environment(glm::vec3(1));
    const Impostor impostor = make_impostor(scene, queries, environment, 1, 64, 0.4f, silent_progress());
    ASSERT_EQ(impostor.faces.size(), 2u);
    EXPECT_EQ(impostor.color.height, 64);
    ImpostorScene cards;
    make_impostor_scene(impostor, cards);
    EXPECT_NO_THROW(validate(cards.patches));
    const RayQueries card_queries(cards.patches);
    // One card looks like the scene from its front and from its back, up to the mask's cutoff.
    for (const ViewFrame& face : impostor.faces) {
        const int width = impostor.color.width / 2;
        const CapturedView full = capture_view(scene, queries, environment, face, width, 64, 16, silent_progress());
        const CapturedView card =
            capture_view(cards.shaded, card_queries, environment, face, width, 64, 16, silent_progress());
        double difference = 0;
        for (std::size_t i = 0; i < full.alpha.pixels.size(); ++i)
            difference +=
                std::abs(double(full.alpha.pixels[i] - card.alpha.pixels[i])) / double(full.alpha.pixels.size());
        EXPECT_LT(difference, 0.25 * coverage(full.alpha)) << "at its edges alone";
        for (std::size_t i = 0; i < card.alpha.pixels.size(); ++i)
            EXPECT_NEAR(card.color.pixels[3 * i + 1], 0.25, 0.008);
    }
    EXPECT_NEAR(impostor.scale, 0.75, 0.02) << "the brightest channel";
    EXPECT_THROW(make_impostor(scene, queries, environment, 0, 64, 0, silent_progress()), InputError);
    EXPECT_THROW(make_impostor(scene, queries, environment, 2, 5000, 0, silent_progress()), InputError);
}

TEST(Impostor, CardsTogetherCoverAboutWhatTheSceneDoesDenseOrSparse) {
    for (const int leaves : {60, 1500}) {
        const PatchScene patches = random_crown(std::size_t(leaves), 7, Optics{});
        const ShadedScene scene = evenly_shaded(patches, glm::vec3(0.5f));
        const RayQueries queries(patches);
        const Environment environment = constant_environment(glm::vec3(1));
        ImpostorScene shown;
        make_impostor_scene(make_impostor(scene, queries, environment, 4, 96, 0.4f, silent_progress()), shown);
        const RayQueries card_queries(shown.patches);
        double full = 0, covered = 0;
        for (int side = 0; side < 9; ++side) {
            const ViewFrame frame = frame_of(patches, 0.4f + 0.7f * float(side));
            full += coverage(capture_view(scene, queries, environment, frame, 64, 64, 4, silent_progress()).alpha);
            covered += coverage(
                capture_view(shown.shaded, card_queries, environment, frame, 64, 64, 4, silent_progress()).alpha);
        }
        EXPECT_NEAR(covered, full, 0.3 * full) << leaves;
    }
}

TEST(Impostor, IsWrittenAsGltf) {
    const PatchScene patches = random_crown(100, 6, Optics{});
    const ShadedScene scene = evenly_shaded(patches, glm::vec3(0.5f));
    const RayQueries queries(patches);
    const Impostor impostor =
        make_impostor(scene, queries, constant_environment(glm::vec3(1)), 3, 32, 0, silent_progress());
    const TemporaryFolder folder;
    write_impostor(folder / "cards.glb", impostor, "crown");
    const GltfDocument document = GltfDocument::read(folder / "cards.glb", silent_progress());
    const tinygltf::Model& model = document.model();
    ASSERT_EQ(model.meshes.size(), 1u);
    const tinygltf::Primitive& primitive = model.meshes[0].primitives[0];
    EXPECT_EQ(document.unsigned_integers(primitive.indices).size(), 36u) << "6 faces of 2 triangles";
    EXPECT_EQ(model.materials[0].alphaMode, "MASK");
    EXPECT_NEAR(model.materials[0].alphaCutoff, impostor.alpha_cutoff, 1e-6);
    EXPECT_FALSE(model.materials[0].doubleSided);
    EXPECT_EQ(model.textures.size(), 2u);
    // Every face looks along its normal.
    const std::vector<float> p = document.floats(primitive.attributes.at("POSITION"), 3),
                             n = document.floats(primitive.attributes.at("NORMAL"), 3);
    const std::vector<std::uint32_t> corners = document.unsigned_integers(primitive.indices);
    for (std::size_t t = 0; t < corners.size(); t += 3) {
        const auto at = [](const std::vector<float>& v, std::uint32_t i) {
            return glm::vec3(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
        };
        const glm::vec3 a = at(p, corners[t]), b = at(p, corners[t + 1]), c = at(p, corners[t + 2]);
        EXPECT_GT(glm::dot(glm::cross(b - a, c - a), at(n, corners[t])), 0);
    }
}

} // namespace
} // namespace kokage
