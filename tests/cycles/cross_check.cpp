#include "tests/cycles/cross_check.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "common/trace/ray_queries.h"
#include "reflection/path_traced_picture.h"

#include <cmath>
#include <sys/resource.h>

namespace kokage {
namespace {

glm::dvec3 mean_of(const Image& image) {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        sum[i % std::size_t(image.channels)] += double(image.pixels[i]);
    return sum / (double(image.width) * image.height);
}

Image mean_image(const Image& a, const Image& b) {
    Image mean = a;
    for (std::size_t i = 0; i < mean.pixels.size(); ++i)
        mean.pixels[i] = 0.5f * (a.pixels[i] + b.pixels[i]);
    return mean;
}

PictureOptions picture_options(const CyclesOptions& options, std::uint64_t seed) {
    PictureOptions picture;
    picture.width = options.width;
    picture.height = options.height;
    picture.samples = options.samples;
    picture.ground = PictureGround::none;
    picture.seed = seed;
    return picture;
}

std::vector<SurfaceLight> render_ours(const CrossCheckScene& checked, const CyclesOptions& options) {
    PatchScene black_patches = checked.patches;
    for (Optics& optics : black_patches.optics)
        optics = {};
    if (black_patches.ground)
        black_patches.ground->albedo = glm::vec3(0.f);
    const ShadedScene scene = checked.shaded();
    ShadedScene black = scene;
    black.patches = &black_patches;
    const RayQueries queries(checked.patches), black_queries(black_patches);
    std::vector<SurfaceLight> pictures;
    for (int i = 0; i < options.pictures; ++i) {
        const PictureOptions picture_of = picture_options(options, std::uint64_t(i) + 1);
        Picture lit =
            render_path_traced(scene, queries, checked.environment, checked.camera, picture_of, silent_progress());
        const Picture unlit = render_path_traced(black, black_queries, checked.environment, checked.camera, picture_of,
                                                 silent_progress());
        for (std::size_t p = 0; p < lit.radiance.pixels.size(); ++p)
            lit.radiance.pixels[p] -= unlit.radiance.pixels[p];
        pictures.push_back({std::move(lit.radiance), std::move(lit.subject)});
    }
    return pictures;
}

double cpu_seconds_of_children() {
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    return double(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
           1e-6 * double(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

SurfaceLight mean_light(const std::vector<SurfaceLight>& two) {
    return {mean_image(two[0].radiance, two[1].radiance), mean_image(two[0].coverage, two[1].coverage)};
}

/// Of the mean of two pictures, over that mean.
glm::dvec3 relative_noise(const std::vector<SurfaceLight>& two) {
    const glm::dvec3 a = mean_of(two[0].radiance), b = mean_of(two[1].radiance);
    return glm::abs(a - b) / (a + b);
}

} // namespace

CrossCheck cross_check(const CrossCheckScene& scene, const CyclesOptions& asked, const std::filesystem::path& folder) {
    CyclesOptions options = asked;
    options.pictures = 2;
    options.samples = std::max(1, asked.samples / 2);
    const Stopwatch watch;
    const std::vector<SurfaceLight> ours = render_ours(scene, options);
    CrossCheck check;
    check.our_cpu_seconds = watch.cpu();
    const double before = cpu_seconds_of_children();
    const std::vector<SurfaceLight> cycles =
        render_in_cycles(scene.shaded(), scene.environment, scene.camera, options, folder);
    check.cycles_cpu_seconds = cpu_seconds_of_children() - before;
    check.ours = mean_light(ours);
    check.cycles = mean_light(cycles);
    check.difference = mean_of(check.ours.radiance) / mean_of(check.cycles.radiance) - 1.0;
    const glm::dvec3 a = relative_noise(ours), b = relative_noise(cycles);
    check.noise = glm::sqrt(a * a + b * b);
    check.coverage = mean_of(check.ours.coverage).x;
    check.coverage_difference = check.coverage / mean_of(check.cycles.coverage).x - 1;
    return check;
}

} // namespace kokage
