#include "foliage/path_traced.h"
#include "common/services/error.h"
#include "common/services/stopwatch.h"
#include "foliage/accuracy.h"
#include "foliage/side_paths.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {
namespace {

constexpr std::uint32_t kPilotPaths = 16, kMostPaths = 1u << 20;

class PathTracedTransport final : public Transport {
  public:
    PathTracedTransport(const PatchScene& scene, const ShadingOptions& options)
        : scene_(scene), options_(options), queries_(scene), points_(scene), optics_(scene.optics) {
        build_ = {"build ray structure", watch_.cpu(), watch_.wall()};
    }

    Solution solve(const Environment& environment, Progress& progress) override {
        Solution solution;
        solution.report.stages.push_back(build_);
        const Stopwatch watch;
        PathTracerOptions tracer_options;
        tracer_options.max_bounces = options_.max_bounces;
        tracer_options.optics = optics_;
        const PathTracer tracer(queries_, environment, tracer_options);
        SidePaths paths(scene_, points_, options_.seed, true);
        if (options_.effort > 0)
            trace_to(std::uint32_t(options_.effort), paths, tracer, progress);
        else
            trace_to_error(paths, tracer, progress, solution.report);
        fill_radiance(paths, solution);
        fill_visibility(paths, solution);
        fill_energy(paths, solution);
        solution.estimated_error = error_of(paths);
        solution.transport_bytes = bytes();
        solution.report.stages.push_back({"trace paths", watch.cpu(), watch.wall()});
        solution.report.counts = {{"leaves", scene_.leaf_count},
                                  {"patches", scene_.patches.size()},
                                  {"paths a leaf side", paths.paths_per_side()},
                                  {"paths", paths.paths_traced()},
                                  {"rays", tracer.rays_traced()}};
        return solution;
    }

    void set_optics(const std::vector<Optics>& optics) override {
        if (optics.size() != scene_.optics.size())
            throw InputError("path-traced: " + std::to_string(optics.size()) +
                             " optics were given for a scene that has " + std::to_string(scene_.optics.size()));
        optics_ = optics;
    }

    std::size_t bytes() const override { return queries_.bytes() + points_.bytes(); }

  private:
    void trace_to(std::uint32_t count, SidePaths& paths, const PathTracer& tracer, Progress& progress) const {
        progress.begin("tracing paths", scene_.patches.size());
        paths.extend_to(count, tracer, progress);
    }

    double error_of(const SidePaths& paths) const {
        return half_sample_error(leaf_side_radiance(scene_, paths.radiance(optics_, 0)),
                                 leaf_side_radiance(scene_, paths.radiance(optics_, 1)));
    }

    /// Error falls as paths^-1/2 or a little faster: from each estimate follows the next count, until it is low enough.
    void trace_to_error(SidePaths& paths, const PathTracer& tracer, Progress& progress, WorkReport& report) const {
        trace_to(kPilotPaths, paths, tracer, progress);
        for (double error = error_of(paths); error > options_.error; error = error_of(paths)) {
            const double ratio = options_.error > 0 ? error / options_.error : INFINITY;
            const double wanted = std::ceil(1.05 * ratio * ratio * paths.paths_per_side());
            if (paths.paths_per_side() >= kMostPaths) {
                report.warnings.push_back("the asked error of " + std::to_string(options_.error) +
                                          " was not reached with 2^20 paths a leaf side; the estimate is " +
                                          std::to_string(error));
                return;
            }
            trace_to(std::uint32_t(std::min<double>(wanted, kMostPaths)), paths, tracer, progress);
        }
    }

    void fill_radiance(const SidePaths& paths, Solution& solution) const {
        solution.radiance = paths.radiance(optics_);
        solution.indirect = solution.radiance;
        for (std::size_t p = 0; p < scene_.patches.size(); ++p) {
            const glm::dvec3 front = paths.side(p, true).from_lights / paths.side(p, true).paths();
            const glm::dvec3 back = paths.side(p, false).from_lights / paths.side(p, false).paths();
            const glm::dvec3 rho(optics_[scene_.patches[p].optics].reflectance),
                tau(optics_[scene_.patches[p].optics].transmittance);
            const auto without = [](const glm::vec3& all, const glm::dvec3& direct) {
                return glm::max(glm::vec3(glm::dvec3(all) - direct / kPiDouble), glm::vec3(0));
            };
            solution.indirect.front[p] = without(solution.radiance.front[p], rho * front + tau * back);
            solution.indirect.back[p] = without(solution.radiance.back[p], rho * back + tau * front);
        }
    }

    void fill_visibility(const SidePaths& paths, Solution& solution) const {
        for (std::size_t p = 0; p < scene_.patches.size(); ++p) {
            const SideSums &front = paths.side(p, true), &back = paths.side(p, false);
            solution.sky_visibility_front.push_back(float(std::min(1.0, front.sees_sky / front.paths())));
            solution.sky_visibility_back.push_back(float(std::min(1.0, back.sees_sky / back.paths())));
            const glm::dvec3 open = front.open_direction / front.paths() + back.open_direction / back.paths();
            const double length = glm::length(open);
            solution.bent_normal.push_back(length > 1e-12 ? glm::vec3(open / length) : glm::vec3(0));
        }
    }

    /// Luminance x m^2. Escaped light takes a patch's radiance and what it sees of the outside as independent within
    /// the patch.
    void fill_energy(const SidePaths& paths, Solution& solution) const {
        for (std::size_t p = 0; p < scene_.patches.size(); ++p) {
            const Optics& optics = optics_[scene_.patches[p].optics];
            const glm::vec3 absorptance = glm::vec3(1) - optics.reflectance - optics.transmittance;
            for (const bool is_front : {true, false}) {
                const SideSums& side = paths.side(p, is_front);
                const glm::dvec3 arriving = side.irradiance(), from_patches = side.from_patches / side.paths();
                const glm::vec3& leaving = is_front ? solution.radiance.front[p] : solution.radiance.back[p];
                const double area = points_.areas()[p];
                const double outside = (side.sees_sky + side.sees_ground) / side.paths();
                solution.energy_in += area * double(luminance(glm::vec3(arriving - from_patches)));
                solution.energy_absorbed +=
                    area * double(luminance(glm::max(absorptance, glm::vec3(0)) * glm::vec3(arriving)));
                solution.energy_escaped += area * kPiDouble * outside * double(luminance(leaving));
            }
        }
    }

    const Stopwatch watch_; ///< first member that is made: times the others
    const PatchScene& scene_;
    const ShadingOptions options_;
    const RayQueries queries_;
    const PatchPoints points_;
    std::vector<Optics> optics_;
    WorkReport::Stage build_;
};

} // namespace

std::unique_ptr<Transport> make_path_traced_transport(const PatchScene& scene, const Tree&,
                                                      const ShadingOptions& options, Progress&) {
    return std::make_unique<PathTracedTransport>(scene, options);
}

PathTracedReference path_trace_reference(const PatchScene& scene, const Environment& environment,
                                         std::uint32_t paths_per_side, std::uint64_t seed, Progress& progress) {
    const RayQueries queries(scene);
    const PatchPoints points(scene);
    const PathTracer tracer(queries, environment);
    SidePaths paths(scene, points, seed, false);
    progress.begin("tracing the reference", scene.patches.size());
    paths.extend_to(paths_per_side, tracer, progress);
    PathTracedReference reference;
    reference.sides = leaf_side_radiance(scene, paths.radiance(scene.optics));
    reference.first = leaf_side_radiance(scene, paths.radiance(scene.optics, 0));
    reference.second = leaf_side_radiance(scene, paths.radiance(scene.optics, 1));
    reference.noise = half_sample_error(reference.first, reference.second);
    reference.paths_per_side = paths.paths_per_side();
    return reference;
}

PathTracedReference merge_references(const PathTracedReference& a, const PathTracedReference& b) {
    if (a.sides.size() != b.sides.size())
        throw InputError("references of " + std::to_string(a.sides.size()) + " and " + std::to_string(b.sides.size()) +
                         " leaf sides can't be merged; they must be of one scene");
    PathTracedReference merged = a;
    merged.paths_per_side = a.paths_per_side + b.paths_per_side;
    const float share = merged.paths_per_side > 0 ? float(double(b.paths_per_side) / merged.paths_per_side) : 0.f;
    const auto mix = [share](std::vector<glm::vec3>& into, const std::vector<glm::vec3>& other) {
        for (std::size_t s = 0; s < into.size(); ++s)
            into[s] = glm::mix(into[s], other[s], share);
    };
    mix(merged.sides, b.sides);
    mix(merged.first, b.first);
    mix(merged.second, b.second);
    merged.noise = half_sample_error(merged.first, merged.second);
    return merged;
}

} // namespace kokage
