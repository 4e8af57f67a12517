#include "foliage/light_maps.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "foliage/convergence.h"
#include "foliage/first_light.h"
#include "foliage/light_map_field.h"

#include <algorithm>
#include <string>

namespace kokage {

namespace {

constexpr int kDefaultMaps = 100;
constexpr int kDirections = 64; // of the lines that first light comes along

LightMapFieldOptions field_options(const ShadingOptions& options) {
    if (options.maps < 0)
        throw InputError("the number of light maps is " + std::to_string(options.maps) +
                         "; it must be at least 1 (--maps)");
    LightMapFieldOptions field;
    field.maps = options.maps > 0 ? options.maps : kDefaultMaps;
    field.bands = options.bands;
    field.gather = options.gather;
    return field;
}

SideIrradiance total(const SideIrradiance& a, const SideIrradiance& b) {
    SideIrradiance result = a;
    for (std::size_t p = 0; p < a.front.size(); ++p) {
        result.front[p] += b.front[p];
        result.back[p] += b.back[p];
    }
    return result;
}

bool absorbs_nothing(const Optics& optics) {
    const glm::vec3 sent_on = optics.reflectance + optics.transmittance;
    return std::max({sent_on.r, sent_on.g, sent_on.b}) >= 1;
}

class LightMapsTransport final : public Transport {
  public:
    LightMapsTransport(const PatchScene& scene, const Tree& tree, const ShadingOptions& options, Progress& progress)
        : scene_(scene), options_(options), optics_(scene.optics), areas_(solid_areas(scene)), queries_(scene),
          ground_(queries_, options.seed, progress),
          field_(queries_, ground_.grid(), tree, field_options(options), progress) {
        made_.stages.push_back({"capturing light maps", watch_.cpu(), watch_.wall()});
        first_light_ = std::make_unique<FirstLightByBundles>(
            scene, ground_.grid(), options.effort > 0 ? options.effort : kDirections, options.seed, progress, made_);
        first_light_->filled_shares(filled_front_, filled_back_);
        watch_.restart();
        field_.set_filled_shares(filled_front_, filled_back_);
        made_.stages.push_back({"weighing light maps", watch_.cpu(), watch_.wall()});
    }

    Solution solve(const Environment& environment, Progress& progress) override;
    void set_optics(const std::vector<Optics>& optics) override { optics_ = optics; }
    std::size_t bytes() const override {
        return field_.bytes() + ground_.bytes() + first_light_->bytes() + areas_.size() * sizeof(double);
    }

  private:
    SideRadiance scatter(const SideIrradiance& first, const SideIrradiance& bounced) const;
    void balance_energy(Solution& solution, const FirstLight& first, const SideIrradiance& bounced,
                        const SideIrradiance& from_ground) const;
    void report(Solution& solution, const Convergence& convergence) const;

    const PatchScene& scene_;
    ShadingOptions options_;
    std::vector<Optics> optics_;
    std::vector<double> areas_;
    Stopwatch watch_;
    RayQueries queries_;
    GroundLight ground_;
    LightMapField field_;
    std::unique_ptr<FirstLightByBundles> first_light_;
    std::vector<float> filled_front_, filled_back_;
    WorkReport made_; ///< of the work before any solution
};

/// B+ = (rho E+ + tau E-)/pi, B- = (rho E- + tau E+)/pi.
SideRadiance LightMapsTransport::scatter(const SideIrradiance& first, const SideIrradiance& bounced) const {
    const std::size_t patches = scene_.patches.size();
    SideRadiance radiance{std::vector<glm::vec3>(patches), std::vector<glm::vec3>(patches)};
    parallel_blocks(patches, 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p) {
            const Optics& optics = optics_[scene_.patches[p].optics];
            const glm::vec3 front = first.front[p] + bounced.front[p], back = first.back[p] + bounced.back[p];
            radiance.front[p] = (optics.reflectance * front + optics.transmittance * back) / kPi;
            radiance.back[p] = (optics.reflectance * back + optics.transmittance * front) / kPi;
        }
    });
    return radiance;
}

Solution LightMapsTransport::solve(const Environment& environment, Progress& progress) {
    Solution solution;
    solution.report = made_;
    Stopwatch watch;
    ground_.set_environment(environment, progress);
    const FirstLight first = first_light_->of(environment, 0.02 * options_.error, progress, solution.report);
    const SideIrradiance direct = total(first.sky, first.lights);
    solution.report.stages.push_back({"first light", watch.cpu(), watch.wall()});

    watch.restart();
    Convergence convergence(options_.max_bounces > 0 ? options_.max_bounces + 1 : 0, 0.1 * options_.error);
    const std::vector<glm::vec3> dark(scene_.patches.size(), glm::vec3(0.f));
    SideIrradiance bounced{dark, dark}, from_ground{dark, dark};
    solution.radiance = {dark, dark};
    progress.begin("bouncing light between maps and leaves", 0);
    for (bool more = true; more;) {
        progress.throw_if_stopped();
        if (!convergence.residuals().empty()) {   // the first shading has seen first light alone
            field_.update(solution.radiance, {}); // lines see the ground better than maps
            from_ground = first_light_->from_ground(ground_.radiance(solution.radiance));
            bounced = total(field_.irradiance(), from_ground);
        }
        SideRadiance next = scatter(direct, bounced);
        more = convergence.another(compare_bounces(solution.radiance, next));
        solution.radiance = std::move(next);
        progress.advance(1);
    }
    solution.indirect = scatter(first.sky, bounced);
    solution.report.stages.push_back({"bounces", watch.cpu(), watch.wall()});

    solution.light_maps = field_.export_maps(cell_means(field_.maps().directions(), environment.remainder));
    solution.sky_visibility_front = first.open_front;
    solution.sky_visibility_back = first.open_back;
    solution.bent_normal = first_light_->bent_normals();
    balance_energy(solution, first, bounced, from_ground);
    report(solution, convergence);
    return solution;
}

/// Into the tree: first light, and what the ground sends. Out of it: what sees the sky or the ground.
void LightMapsTransport::balance_energy(Solution& solution, const FirstLight& first, const SideIrradiance& bounced,
                                        const SideIrradiance& from_ground) const {
    const SideIrradiance direct = total(first.sky, first.lights), in = total(direct, from_ground),
                         received = total(direct, bounced);
    for (std::size_t p = 0; p < scene_.patches.size(); ++p) {
        const Optics& optics = optics_[scene_.patches[p].optics];
        const glm::vec3 absorbed = 1.f - optics.reflectance - optics.transmittance;
        solution.energy_in += areas_[p] * luminance(in.front[p] + in.back[p]);
        solution.energy_absorbed += areas_[p] * luminance(absorbed * (received.front[p] + received.back[p]));
        solution.energy_escaped += areas_[p] * kPiDouble *
                                   (luminance(solution.radiance.front[p]) * (1 - filled_front_[p]) +
                                    luminance(solution.radiance.back[p]) * (1 - filled_back_[p]));
    }
}

void LightMapsTransport::report(Solution& solution, const Convergence& convergence) const {
    solution.residuals = convergence.residuals();
    solution.transport_bytes = bytes();
    auto& counts = solution.report.counts;
    counts.push_back({"leaves", scene_.leaf_count});
    counts.push_back({"patches", scene_.patches.size()});
    counts.push_back({"maps", field_.maps().places().size()});
    counts.push_back({"branching points", field_.placement().candidates});
    counts.push_back({"capture directions", field_.maps().directions().size()});
    counts.push_back({"rays", field_.maps().seen().seen.size() + ground_.rays_traced()});
    first_light_->count(solution.report);
    counts.push_back({"bounces", convergence.residuals().size() - 1});
    if (const std::size_t unread = field_.unread_maps(); unread > 0)
        solution.report.skips.push_back(
            {std::to_string(unread) + " of " + std::to_string(field_.placement().places.size()) + " light maps",
             "no leaf or piece of bark is near enough to read them",
             std::to_string(unread * field_.maps().directions().size()) + " capture rays"});
    if (!field_.placement().note.empty())
        solution.report.warnings.push_back(field_.placement().note);
    if (std::any_of(optics_.begin(), optics_.end(), absorbs_nothing))
        solution.report.warnings.push_back(
            "a material absorbs nothing (rho + tau = 1): bounces do not provably contract, "
            "they end only by light that leaves the tree");
    if (const std::string warning = convergence.warning(); !warning.empty())
        solution.report.warnings.push_back(warning);
}

} // namespace

std::unique_ptr<Transport> make_light_maps_transport(const PatchScene& scene, const Tree& tree,
                                                     const ShadingOptions& options, Progress& progress) {
    return std::make_unique<LightMapsTransport>(scene, tree, options, progress);
}

} // namespace kokage
