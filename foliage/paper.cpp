// Tanaka, Akagi, Kitajima: A Shading Method for a Tree Model Based on Spherical Harmonics in Multi-Lights Environment
// [F].
#include "foliage/paper.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "foliage/convergence.h"
#include "foliage/map_reading.h"
#include "foliage/open_sky.h"
#include "foliage/patch_geometry.h"

#include <string>

namespace kokage {

namespace {

constexpr int kDefaultPaperMaps = 15; // as in [F] fig 4
constexpr int kLeastDirections = 968; // 22 rings of 44: about 20 rays for each of 49 coefficients
constexpr int kLightSamples = 16;
constexpr int kMostBands = 40;

class PaperTransport final : public Transport {
  public:
    PaperTransport(const PatchScene& scene, const Tree& tree, const ShadingOptions& options, Progress& progress)
        : scene_(scene), options_(options), optics_(scene.optics), geometry_(patch_geometry(scene)), queries_(scene),
          placement_(place_light_maps(tree, options.maps > 0 ? options.maps : kDefaultPaperMaps)),
          ground_(queries_, options.seed, progress),
          maps_(queries_, ground_.grid(), placement_.places, options.bands, kLeastDirections, progress),
          visibility_(queries_, maps_.points(), kLightSamples, options.seed),
          energy_(queries_, options.seed, progress) {
        stages_.push_back({"capturing light maps", watch_.cpu(), watch_.wall()});
    }

    Solution solve(const Environment& environment, Progress& progress) override;
    void set_optics(const std::vector<Optics>& optics) override { optics_ = optics; }
    std::size_t bytes() const override {
        return maps_.bytes() + ground_.bytes() + visibility_.bytes() + geometry_.centres.size() * 2 * sizeof(glm::vec3);
    }

  private:
    /// Share of the light of its surroundings that a patch sends on: rho + tau, for bark its albedo.
    glm::vec3 albedo(std::size_t patch) const {
        const Optics& optics = optics_[scene_.patches[patch].optics];
        return optics.reflectance + optics.transmittance;
    }
    SideRadiance shade(const std::vector<glm::vec3>& means) const;
    void report(Solution& solution, const Convergence& convergence, const std::vector<glm::vec3>& means) const;

    const PatchScene& scene_;
    ShadingOptions options_;
    std::vector<Optics> optics_;
    Stopwatch watch_;
    PatchGeometry geometry_;
    RayQueries queries_;
    LightMapPlacement placement_;
    GroundLight ground_;
    CapturedMaps maps_;
    LightVisibility visibility_;
    OpenSky energy_;
    std::vector<WorkReport::Stage> stages_;
};

/// Both sides alike, without a cosine.
SideRadiance PaperTransport::shade(const std::vector<glm::vec3>& means) const {
    SideRadiance radiance;
    radiance.front.resize(means.size());
    for (std::size_t p = 0; p < means.size(); ++p)
        radiance.front[p] = albedo(p) * glm::max(means[p], glm::vec3(0.f));
    radiance.back = radiance.front;
    return radiance;
}

Solution PaperTransport::solve(const Environment& environment, Progress& progress) {
    Stopwatch watch;
    const std::size_t patches = scene_.patches.size();
    ground_.set_environment(environment, progress);
    MapCoefficients lights(maps_.places().size(), options_.bands);
    maps_.add_lights(environment, visibility_, queries_.ray_offset(), lights, progress);
    visibility_.forget_unused();
    MapCoefficients outside = lights; // what comes from outside of the tree: lights and sky
    maps_.add_sky(cell_means(maps_.directions(), environment.remainder), outside);

    Solution solution;
    solution.radiance = {std::vector<glm::vec3>(patches, glm::vec3(0.f)),
                         std::vector<glm::vec3>(patches, glm::vec3(0.f))};
    solution.report.stages = stages_;
    solution.report.stages.push_back({"projecting lights and sky", watch.cpu(), watch.wall()});

    watch.restart();
    Convergence convergence(options_.max_bounces > 0 ? options_.max_bounces + 1 : 0, 0.1 * options_.error);
    MapCoefficients coefficients;
    std::vector<glm::vec3> means, first_means;
    progress.begin("bouncing light between maps and leaves", 0);
    for (bool more = true; more;) {
        progress.throw_if_stopped();
        coefficients = outside;
        maps_.add_surfaces(solution.radiance, ground_.radiance(solution.radiance), coefficients);
        means = mean_of_maps(maps_.places(), coefficients, geometry_.centres);
        if (first_means.empty())
            first_means = means;
        SideRadiance next = shade(means);
        more = convergence.another(compare_bounces(solution.radiance, next));
        solution.radiance = std::move(next);
        progress.advance(1);
    }
    const std::vector<glm::vec3> from_lights = mean_of_maps(maps_.places(), lights, geometry_.centres);
    std::vector<glm::vec3> without_lights(patches);
    for (std::size_t p = 0; p < patches; ++p)
        without_lights[p] = glm::max(means[p], glm::vec3(0.f)) - glm::max(from_lights[p], glm::vec3(0.f));
    solution.indirect = shade(without_lights);
    solution.light_maps = maps_.export_maps(coefficients);
    solution.report.stages.push_back({"bounces", watch.cpu(), watch.wall()});

    // Energy by the paper's own reckoning, pi S on either side; what escapes is measured by rays, so that the balance
    // shows what its uniform mean loses or gains.
    for (std::size_t p = 0; p < patches; ++p) {
        const double sides =
            scene_.patches[p].kind == PatchKind::bark ? 1 : 2; // wood is closed: its inside takes no light
        const double scale = sides * kPiDouble * energy_.areas()[p];
        const glm::dvec3 lost = (1.0 - glm::dvec3(albedo(p))) * scale * glm::dvec3(glm::max(means[p], glm::vec3(0.f)));
        const glm::dvec3 in = scale * glm::dvec3(glm::max(first_means[p], glm::vec3(0.f)));
        solution.energy_in += luminance(glm::vec3(in));
        solution.energy_absorbed += luminance(glm::vec3(lost));
    }
    solution.energy_escaped = energy_.escaping_power(solution.radiance);
    report(solution, convergence, means);
    return solution;
}

void PaperTransport::report(Solution& solution, const Convergence& convergence,
                            const std::vector<glm::vec3>& means) const {
    std::uint64_t negative = 0;
    for (const glm::vec3& mean : means)
        negative += mean.r < 0 || mean.g < 0 || mean.b < 0;
    solution.residuals = convergence.residuals();
    solution.transport_bytes = bytes();
    auto& counts = solution.report.counts;
    counts.push_back({"leaves", scene_.leaf_count});
    counts.push_back({"patches", scene_.patches.size()});
    counts.push_back({"maps", maps_.places().size()});
    counts.push_back({"branching points", placement_.candidates});
    counts.push_back({"capture directions", maps_.directions().size()});
    counts.push_back(
        {"rays", maps_.seen().seen.size() + ground_.rays_traced() + visibility_.rays_traced() + energy_.rays_traced()});
    counts.push_back({"bounces", convergence.residuals().size() - 1});
    counts.push_back({"patches whose mean light was negative and counts as 0", negative});
    if (!placement_.note.empty())
        solution.report.warnings.push_back(placement_.note);
    if (const std::string warning = convergence.warning(); !warning.empty())
        solution.report.warnings.push_back(warning);
}

} // namespace

std::unique_ptr<Transport> make_paper_transport(const PatchScene& scene, const Tree& tree,
                                                const ShadingOptions& options, Progress& progress) {
    if (options.maps < 0)
        throw InputError("the number of light maps is " + std::to_string(options.maps) +
                         "; it must be at least 1 (--maps)");
    if (options.bands < 1 || options.bands > kMostBands)
        throw InputError("light maps of " + std::to_string(options.bands) + " bands are asked for; 1 to " +
                         std::to_string(kMostBands) + " are possible (--bands)");
    return std::make_unique<PaperTransport>(scene, tree, options, progress);
}

} // namespace kokage
