// Renders scenes by our path tracer and in Blender's Cycles, and says how far apart they are:
//
//     kokage_compare_with_cycles FOLDER [WIDTHxHEIGHT SAMPLES [SCENE]...]      (all of small, oak, maple, cards if none
//     is named)
//
// FOLDER gets, for each scene, ours.exr, cycles.exr (light of surfaces alone), error.png (their difference's size) and
// what Blender was given. KOKAGE_DATA must name the data folder for "cards". Ends with 1 if a scene's mean radiance
// differs by more than 1 % in a channel.
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/compare_images.h"
#include "tests/cycles/cross_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>

namespace kokage {
namespace {

constexpr double kLargestDifference = 0.01;

struct Choice {
    const char* name;
    std::function<CrossCheckScene()> make;
};

std::vector<Choice> choices() {
    const char* data = std::getenv("KOKAGE_DATA");
    const std::filesystem::path folder = data ? data : "";
    return {{"small", small_scene},
            {"oak", oak_in_the_open},
            {"maple", under_a_maple},
            {"cards", [folder] { return cards_and_teapot(folder); }}};
}

/// True if they agree.
bool report(const CrossCheckScene& scene, const CrossCheck& check, const std::filesystem::path& folder) {
    save_image(folder / "ours.exr", check.ours.radiance);
    save_image(folder / "cycles.exr", check.cycles.radiance);
    const ImageComparison comparison = compare_images(check.ours.radiance, check.cycles.radiance);
    save_image(folder / "error.png", comparison.map, {.png_encoding = PngEncoding::as_is});
    std::printf("%s: %s\n", scene.name.c_str(), scene.description.c_str());
    std::printf("  mean radiance, ours over Cycles': R %+.2f %%, G %+.2f %%, B %+.2f %%  (noise %.2f, %.2f, %.2f)\n",
                100 * check.difference.r, 100 * check.difference.g, 100 * check.difference.b, 100 * check.noise.r,
                100 * check.noise.g, 100 * check.noise.b);
    std::printf("  surfaces cover %.2f %% of the picture, in Cycles %+.2f %% of that\n", 100 * check.coverage,
                -100 * check.coverage_difference);
    std::printf("  pixel by pixel, noise and all: %s\n", describe(comparison).c_str());
    std::printf("  CPU: ours %.1f s, Blender %.1f s\n", check.our_cpu_seconds, check.cycles_cpu_seconds);
    std::fflush(stdout);
    const glm::dvec3 apart = glm::abs(check.difference);
    return std::max({apart.r, apart.g, apart.b}) <= kLargestDifference;
}

int run(const std::filesystem::path& folder, const CyclesOptions& options, const std::vector<std::string>& only) {
    if (const auto why = why_no_blender())
        throw InputError(*why);
    bool agree = true;
    for (const Choice& choice : choices()) {
        if (!only.empty() && std::find(only.begin(), only.end(), choice.name) == only.end())
            continue;
        const std::filesystem::path files = folder / choice.name;
        std::filesystem::create_directories(files);
        try {
            const CrossCheckScene scene = choice.make();
            agree &= report(scene, cross_check(scene, options, files), files);
        } catch (const InputError& error) {
            std::printf("skipped: %s: %s\n", choice.name, error.what());
        }
    }
    return agree ? 0 : 1;
}

} // namespace
} // namespace kokage

int main(int count, char** arguments) {
    kokage::CyclesOptions options{.width = 480, .height = 360, .samples = 256};
    const bool sized = count > 3 && std::sscanf(arguments[2], "%dx%d", &options.width, &options.height) == 2;
    if (count < 2 || (count > 2 && !sized)) {
        std::fprintf(stderr, "usage: kokage_compare_with_cycles FOLDER [WIDTHxHEIGHT SAMPLES [SCENE]...]\n");
        return 2;
    }
    if (sized)
        options.samples = std::atoi(arguments[3]);
    try {
        return kokage::run(arguments[1], options, {arguments + std::min(count, 4), arguments + count});
    } catch (const std::exception& error) {
        std::fprintf(stderr, "kokage_compare_with_cycles: %s\n", error.what());
        return 2;
    }
}
