#include "foliage/bundles/bundles.h"

#include "common/services/stopwatch.h"
#include "foliage/bundles/drawn_bundles.h"
#include "foliage/bundles/half_difference.h"
#include "foliage/bundles/model_error.h"
#include "foliage/bundles/outside_light.h"
#include "foliage/bundles/ray_link_tracing.h"
#include "foliage/bundles/steps.h"
#include "foliage/capture_directions.h"
#include "foliage/divided_leaves.h"
#include "foliage/light_map_field.h"
#include "foliage/path_traced.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

namespace kokage {
namespace {

using namespace bundles;

/// The sampling error that leaves room for what sampling can't mend.
double sampling_error_for(double error, double model_error) {
    return std::sqrt(std::max(error * error - model_error * model_error, 1e-8));
}

/// A fifth of room for sampling: with less, the number of lines runs away.
constexpr double kRoom = 1.2;

/// Light maps as [F] places them, showing the solved light; none where the tree is not the scene's.
void add_light_maps(const PatchScene& scene, const Tree& tree, const ShadingOptions& options,
                    const Environment& environment, Solution& solution, Progress& progress) {
    constexpr int kDefaultMaps = 15;
    if (scene.leaf_count != tree.leaves.size() || scene.leaf_count == 0)
        return;
    const RayQueries queries(scene);
    const GroundCells ground = make_ground_cells(scene);
    LightMapFieldOptions maps;
    maps.maps = options.maps > 0 ? options.maps : kDefaultMaps;
    maps.bands = options.bands;
    LightMapField field(queries, ground, tree, maps, progress);
    field.update(solution.radiance, {});
    solution.light_maps = field.export_maps(cell_means(field.maps().directions(), environment.remainder));
}

class BundlesTransport : public Transport {
  public:
    /// `tree`: null = no light maps; `reach`: null = never gives up.
    BundlesTransport(const PatchScene& scene, const BundleEffort& effort, const ShadingOptions& options, bool adaptive,
                     Progress& progress, const Tree* tree, Reach* reach)
        : scene_(scene), tree_(tree), options_(options), adaptive_(adaptive), reach_(reach), optics_(scene.optics) {
        Stopwatch watch;
        drawn_ = std::make_unique<DrawnBundles>(scene);
        model_error_ = std::make_unique<ModelError>(scene, drawn_->facets(), effort.uniform_side_error);
        pending_.stages.push_back({"facets", watch.cpu(), watch.wall()});
        draw(effort, progress);
    }

    Solution solve(const Environment& environment, Progress& progress) override;
    void set_optics(const std::vector<Optics>& optics) override { optics_ = optics; }
    std::size_t bytes() const override;

  private:
    struct Lit {
        BeamLight beams;
        OutsideLight outside;
        SweepResult light;
        double sampling_error = 0;
        std::vector<Rgb> irradiance, half_differences;
    };

    void draw(const BundleEffort& effort, Progress& progress);
    Lit light(const Environment& environment, Progress& progress, WorkReport& report);
    SamplingError sampling_error(const Lit& lit) const;
    void report_no_check(const Lit& lit, const Environment& environment, WorkReport& report) const;
    SolutionError judge(const Lit& lit, const Environment& environment, Progress& progress, WorkReport& report);
    std::optional<BundleEffort> more_lines(const Lit& lit, const SolutionError& error) const;
    bool reached(const SolutionError& error) const;
    bool model_known(const Lit& lit, const SolutionError& error) const;
    bool out_of_reach(const Lit& lit, const SolutionError& error) const;
    void fill(Solution& solution, const Lit& lit) const;
    void balance(Solution& solution, const Lit& lit) const;
    void add_host_data(const Environment& environment, Solution& solution, Progress& progress) const;

    const PatchScene& scene_;
    const Tree* tree_; ///< null: no light maps
    ShadingOptions options_;
    bool adaptive_;
    Reach* reach_;
    std::vector<Optics> optics_;
    std::unique_ptr<DrawnBundles> drawn_;
    std::unique_ptr<BounceOperator> bounces_;
    std::unique_ptr<ModelError> model_error_;
    std::vector<Rgb> last_radiance_;
    WorkReport pending_; ///< of work since the last solution
};

void BundlesTransport::draw(const BundleEffort& effort, Progress& progress) {
    drawn_->draw(effort, leaves_too_small_for_lines(scene_, drawn_->facets(), effort.lines), progress, pending_);
    bounces_ = std::make_unique<BounceOperator>(scene_, drawn_->transport());
    model_error_->forget();
}

std::size_t BundlesTransport::bytes() const {
    return drawn_->bytes() + model_error_->bytes();
}

/// Adds the lights to what the sky gives to every side.
void add_lights(const BeamLight& beams, SkyLight& sky) {
    for (std::size_t s = 0; s < sky.all.irradiance.size(); ++s) {
        const glm::vec3 first = beams.halves[0][s].vec(), second = beams.halves[1][s].vec();
        auto add = [s](SideLight& side, const glm::vec3& light) {
            side.irradiance[s] = Rgb::from(side.irradiance[s].vec() + light);
        };
        add(sky.halves[0], first);
        add(sky.halves[1], second);
        add(sky.all, 0.5f * (first + second));
    }
}

/// Sky and lights together, moved out of `sky`.
OutsideLight outside_light(SkyLight& sky, const BeamLight& beams) {
    OutsideLight light;
    static_cast<SideLight&>(light) = std::move(sky.all);
    light.near_radiance = std::move(sky.near_radiance);
    light.open_ground_irradiance = sky.open_ground_irradiance + beams.open_ground;
    light.ground_irradiance = beams.ground;
    for (glm::vec3& irradiance : light.ground_irradiance)
        irradiance += sky.open_ground_irradiance;
    return light;
}

BundlesTransport::Lit BundlesTransport::light(const Environment& environment, Progress& progress, WorkReport& report) {
    Stopwatch watch;
    auto stage = [&](const char* name) {
        report.stages.push_back({name, watch.cpu(), watch.wall()});
        watch.restart();
        progress.throw_if_stopped();
    };
    Lit lit;
    lit.beams = drawn_->light(environment, options_.merge_weak_lights ? 0.02 * options_.error : 0, options_.seed,
                              progress, report);
    stage("lights");
    SkyLight sky =
        gather_sky(scene_, drawn_->facets(), drawn_->transport(), environment.remainder, lit.beams.open_ground);
    add_lights(lit.beams, sky);
    lit.outside = outside_light(sky, lit.beams);
    stage("sky");
    SweepLimits limits;
    limits.tolerance = drawn_->effort().tolerance;
    // The leaf that is looked at scatters, too: that is one sweep more than there are scatterings before it.
    limits.max_bounces = options_.max_bounces > 0 ? options_.max_bounces + 1 : 0;
    lit.light =
        bounces_->solve(lit.outside, optics_, limits, limits.max_bounces > 0 ? std::vector<Rgb>() : last_radiance_);
    stage("bounces");
    HalvesResult halves = bounces_->scatter_by_halves(sky.halves, optics_, lit.light);
    if (options_.max_bounces == 0)
        bounces_->remove_shared_lines(sky.halves, optics_, halves.half_difference, lit.light);
    bounces_->spread(lit.outside.open, optics_, halves.half_difference); // errors bounce, too
    lit.half_differences = std::move(halves.half_difference);
    lit.sampling_error = half_difference_error(scene_, lit.light.radiance, lit.half_differences);
    lit.irradiance = std::move(halves.irradiance);
    stage("error estimate");
    return lit;
}

void BundlesTransport::fill(Solution& solution, const Lit& lit) const {
    const std::size_t patches = scene_.patches.size();
    for (SideRadiance* radiance : {&solution.radiance, &solution.indirect}) {
        radiance->front.resize(patches);
        radiance->back.resize(patches);
    }
    solution.sky_visibility_front.resize(patches);
    solution.sky_visibility_back.resize(patches);
    for (std::size_t p = 0; p < patches; ++p) {
        const Optics& optics = optics_[scene_.patches[p].optics];
        const Side front = Side(2 * p), back = front + 1;
        const glm::vec3 lit_front = lit.beams.mean(front), lit_back = lit.beams.mean(back);
        solution.radiance.front[p] = lit.light.radiance[front].vec();
        solution.radiance.back[p] = lit.light.radiance[back].vec();
        const glm::vec3 direct_front = (optics.reflectance * lit_front + optics.transmittance * lit_back) / kPi;
        const glm::vec3 direct_back = (optics.reflectance * lit_back + optics.transmittance * lit_front) / kPi;
        solution.indirect.front[p] = glm::max(solution.radiance.front[p] - direct_front, 0.f);
        solution.indirect.back[p] = glm::max(solution.radiance.back[p] - direct_back, 0.f);
        solution.sky_visibility_front[p] = lit.outside.open[front] - (scene_.ground ? lit.outside.down[front] : 0.f);
        solution.sky_visibility_back[p] = lit.outside.open[back] - (scene_.ground ? lit.outside.down[back] : 0.f);
    }
}

/// Luminance of what both sides of a patch absorb, by area. Told from what they send out, (rho + tau) / pi of what they
/// receive together, so that it fits the light that leaves; black ones from what they receive.
double absorbed(const Optics& optics, const glm::vec3& leaving, const glm::vec3& received) {
    const glm::vec3 albedo = optics.reflectance + optics.transmittance;
    glm::vec3 absorbed(0.f);
    for (std::size_t c = 0; c < 3; ++c)
        absorbed[c] = (1 - albedo[c]) * (albedo[c] > 1e-3f ? kPi * leaving[c] / albedo[c] : received[c]);
    return luminance(absorbed);
}

void BundlesTransport::balance(Solution& solution, const Lit& lit) const {
    const double to_square_metres = 1 / (drawn_->facets().scale * drawn_->facets().scale);
    for (std::size_t p = 0; p < scene_.patches.size(); ++p) {
        const double area = drawn_->facets().patch_area[p] * to_square_metres;
        const std::size_t front = 2 * p, back = front + 1;
        solution.energy_absorbed += area * absorbed(optics_[scene_.patches[p].optics],
                                                    lit.light.radiance[front].vec() + lit.light.radiance[back].vec(),
                                                    lit.irradiance[front].vec() + lit.irradiance[back].vec());
        for (std::size_t side : {front, back}) {
            solution.energy_in += area * luminance(lit.outside.irradiance[side].vec());
            solution.energy_escaped +=
                area * kPiDouble * lit.outside.open[side] * luminance(lit.light.radiance[side].vec());
        }
    }
}

SamplingError BundlesTransport::sampling_error(const Lit& lit) const {
    return {lit.sampling_error, usual_sampling_error(drawn_->effort(), mean_leaf_albedo(scene_))};
}

/// That nobody looked where there may be much.
void BundlesTransport::report_no_check(const Lit& lit, const Environment& environment, WorkReport& report) const {
    if (!options_.check_by_paths &&
        !model_error_->known(sampling_error(lit), {environment, optics_, options_.max_bounces}))
        report.skips.push_back({"check of the leaves' light by paths",
                                "what one radiance a side gets wrong is gathered anew where the camera looks",
                                "12,000 to 400,000 paths, and leaves in parts or paths in place of bundles where they "
                                "find too much"});
}

SolutionError BundlesTransport::judge(const Lit& lit, const Environment& environment, Progress& progress,
                                      WorkReport& report) {
    const LightAndMatter now{environment, optics_, options_.max_bounces};
    const SamplingError sampling = sampling_error(lit);
    auto measure = [&] {
        Stopwatch watch;
        const SolutionError error = model_error_->measure(sampling, lit.light.radiance, lit.half_differences, now,
                                                          options_.seed, progress, report);
        report.stages.push_back({"check by paths", watch.cpu(), watch.wall()});
        return error;
    };
    const std::optional<SolutionError> known = model_error_->known(sampling, now);
    if (!options_.check_by_paths)
        return {sampling.shown, 0, false};
    const SolutionError error = known ? *known : measure();
    // One measurement may decide to go on, but not where to end.
    if (adaptive_ && error.measured && !model_error_->measured_twice() && !more_lines(lit, error))
        return measure();
    return error;
}

/// More lines that should reach the asked error; empty if it is reached, or they are no use.
std::optional<BundleEffort> BundlesTransport::more_lines(const Lit& lit, const SolutionError& error) const {
    if (reached(error) || out_of_reach(lit, error))
        return {};
    // Where it had to be measured and can't be told yet, it is seldom small; too few lines now cost another round.
    constexpr double kLikelyShare = 0.6;
    const double assumed = options_.check_by_paths ? drawn_->effort().uniform_side_error : 0;
    const double model = !error.measured           ? assumed
                         : model_known(lit, error) ? error.model
                                                   : std::max(assumed, kLikelyShare * options_.error);
    const double ratio = lit.sampling_error / sampling_error_for(options_.error, model);
    if (ratio <= 1.05)
        return {};
    const int directions = drawn_->effort().lines.sky_directions + drawn_->effort().lines.link_directions;
    // Evenly spread lines: the error falls faster than 1 / sqrt(lines), about as lines^-0.63 on grown oaks.
    // All are drawn anew: small steps, which a measurement's scatter may ask for one after the other, cost more.
    const double least = error.measured ? 1.4 : 1.0;
    const double wanted = directions * std::clamp(1.1 * std::pow(ratio, 1.6), least, 16.0);
    BundleEffort more =
        effort_of_directions(int(std::min(std::ceil(wanted), 1e6)), mean_leaf_albedo(scene_), options_.seed);
    if (more.lines.sky_directions + more.lines.link_directions <= directions)
        return {};
    more.tolerance = drawn_->effort().tolerance;
    return more;
}

/// A measurement scatters by 15 %: what it finds a little too large is not worth another round.
bool BundlesTransport::reached(const SolutionError& error) const {
    return error.all <= (error.measured ? 1.08 : 1.02) * options_.error;
}

/// What is measured beneath a sampling error that is much larger than the error asked for is mostly noise, unless it is
/// larger still; and then it may be that of a coarse ground, which more lines make finer.
bool BundlesTransport::model_known(const Lit& lit, const SolutionError& error) const {
    constexpr double kMuch = 1.5;
    constexpr int kFineGround = 64;
    const std::optional<GroundGrid>& ground = drawn_->transport().ground;
    return error.measured && (lit.sampling_error <= kMuch * options_.error ||
                              (error.model > lit.sampling_error && (!ground || ground->size >= kFineGround)));
}

/// No number of lines would do, and there is another way.
bool BundlesTransport::out_of_reach(const Lit& lit, const SolutionError& error) const {
    return !reached(error) && model_known(lit, error) && kRoom * error.model > options_.error && reach_ &&
           reach_->may_give_up;
}

/// Bent normals, and light maps.
void BundlesTransport::add_host_data(const Environment& environment, Solution& solution, Progress& progress) const {
    Stopwatch watch;
    solution.bent_normal = mean_open_directions(drawn_->facets(), drawn_->transport());
    if (tree_)
        add_light_maps(scene_, *tree_, options_, environment, solution, progress);
    solution.report.stages.push_back({"bent normals and light maps", watch.cpu(), watch.wall()});
}

Solution BundlesTransport::solve(const Environment& environment, Progress& progress) {
    constexpr int kMostAttempts = 4;
    Solution solution;
    solution.report = std::move(pending_);
    pending_ = {};
    Lit lit;
    SolutionError error;
    for (int attempt = 1;; ++attempt) {
        lit = light(environment, progress, solution.report);
        error = judge(lit, environment, progress, solution.report);
        if (!adaptive_)
            break;
        if (out_of_reach(lit, error)) {
            reach_->gave_up = true;
            return solution;
        }
        const std::optional<BundleEffort> more = more_lines(lit, error);
        if (!more || attempt == kMostAttempts)
            break;
        draw(*more, progress);
        solution.report.append(pending_);
        pending_ = {};
        last_radiance_ = lit.light.radiance;
    }
    fill(solution, lit);
    balance(solution, lit);
    report_no_check(lit, environment, solution.report);
    if (adaptive_ && error.all > 1.1 * options_.error)
        solution.report.warnings.push_back(
            "the asked error was not reached; ask for path-traced, or for a larger error");
    solution.residuals = lit.light.residuals;
    solution.estimated_error = error.all;
    if (options_.for_hosts)
        add_host_data(environment, solution, progress);
    last_radiance_ = std::move(lit.light.radiance);
    solution.transport_bytes = bytes();
    auto count = [&](const char* name, std::uint64_t value) { solution.report.counts.push_back({name, value}); };
    count("patches", scene_.patches.size());
    drawn_->count(solution.report);
    count("sweeps", solution.residuals.size());
    return solution;
}

/// Says from the start that paths are traced instead of bundles, which may take long.
class ProgressInstead : public Progress {
  public:
    explicit ProgressInstead(Progress& progress) : progress_(progress) {}
    void begin(std::string_view stage, std::size_t total) override {
        progress_.begin(std::string(stage) + " instead of bundles, which can't reach the asked error", total);
    }
    void advance(std::size_t steps) override { progress_.advance(steps); }
    bool stop_requested() const override { return progress_.stop_requested(); }

  private:
    Progress& progress_;
};

/// Path tracing where bundles can't reach the asked error; the report says so.
class PathTracedInstead : public Transport {
  public:
    PathTracedInstead(const PatchScene& scene, const Tree& tree, const ShadingOptions& options, Progress& progress)
        : scene_(scene), tree_(tree), options_(options),
          transport_(make_path_traced_transport(scene, tree, options, progress)) {}
    Solution solve(const Environment& environment, Progress& progress) override {
        ProgressInstead instead(progress);
        Solution solution = transport_->solve(environment, instead);
        if (options_.for_hosts) {
            Stopwatch watch;
            add_light_maps(scene_, tree_, options_, environment, solution, progress);
            solution.report.stages.push_back({"light maps", watch.cpu(), watch.wall()});
        }
        solution.method_instead = method_name(Method::path_traced);
        solution.report.warnings.push_back(
            "paths were traced instead of bundles: one radiance a leaf side, even in parts, "
            "can't reach the asked error");
        return solution;
    }
    void set_optics(const std::vector<Optics>& optics) override { transport_->set_optics(optics); }
    std::size_t bytes() const override { return transport_->bytes(); }

  private:
    const PatchScene& scene_;
    const Tree& tree_;
    const ShadingOptions options_;
    std::unique_ptr<Transport> transport_;
};

} // namespace

std::unique_ptr<Transport> make_bundles_transport(const PatchScene& scene, const BundleEffort& effort,
                                                  const ShadingOptions& options, Progress& progress) {
    return std::make_unique<BundlesTransport>(scene, effort, options, false, progress, nullptr, nullptr);
}

std::unique_ptr<Transport> make_refined_bundles_transport(const PatchScene& scene, const BundleEffort& first,
                                                          const ShadingOptions& options, Progress& progress) {
    return std::make_unique<BundlesTransport>(scene, first, options, true, progress, nullptr, nullptr);
}

std::unique_ptr<Transport> make_bundles_transport(const PatchScene& scene, const Tree& tree,
                                                  const ShadingOptions& options, Progress& progress) {
    const bool adaptive = options.effort == 0;
    // `tree` and `scene` outlive the transport, `options` may not.
    auto make = [&tree, options, adaptive,
                 albedo = mean_leaf_albedo(scene)](const PatchScene& patches, double uniform_side_error, Reach& reach,
                                                   Progress& stop) -> std::unique_ptr<Transport> {
        const double sampling_error =
            options.check_by_paths ? sampling_error_for(options.error, uniform_side_error) : options.error;
        BundleEffort effort = effort_of_directions(
            adaptive ? directions_for_error(sampling_error, albedo) : options.effort, albedo, options.seed);
        effort.uniform_side_error = uniform_side_error;
        effort.tolerance = std::min(effort.tolerance, 0.06 * options.error);
        return std::make_unique<BundlesTransport>(patches, effort, options, adaptive, stop, &tree, &reach);
    };
    auto whole = [make, &scene](Reach& reach, Progress& stop) { return make(scene, kUniformSideError, reach, stop); };
    if (!adaptive || !options.check_by_paths)
        return make_steps({whole}, progress);
    auto divided = [make, &scene, &tree](Reach& reach, Progress& stop) {
        return make_divided_transport(
            scene, tree, 1, [&](const PatchScene& parts) { return make(parts, kUniformSideError / 2, reach, stop); });
    };
    auto paths = [&scene, &tree, options](Reach&, Progress& stop) -> std::unique_ptr<Transport> {
        return std::make_unique<PathTracedInstead>(scene, tree, options, stop);
    };
    std::vector<StepMaker> steps; // those that are out of reach for any crown are left out
    if (options.error >= kRoom * kUniformSideError)
        steps.emplace_back(whole);
    if (options.error >= kRoom * kUniformSideError / 2 && can_divide_leaves(scene, tree))
        steps.emplace_back(divided);
    steps.emplace_back(paths);
    return make_steps(std::move(steps), progress);
}

} // namespace kokage
