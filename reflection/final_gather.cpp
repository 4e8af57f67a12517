#include "reflection/final_gather.h"
#include "common/directions/about_axis.h"
#include "common/environment/lat_long.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "common/trace/path_numbers.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr int kRowsAtOnce = 32;
/// How many rays the mean correction of a look counts as, beside a patch's own: a ray's light varies about four times
/// as much (in standard deviation) as patches' corrections do; of lobes, hardly more than they do.
constexpr double kRaysOfPrior = 16, kLobesOfPrior = 2;
/// Rays of a patch (or corner) after which more are not worth their time. A patch that has so many pixels is large: the
/// eye would miss how its reflections change, so they are traced pixel by pixel.
constexpr float kEnough = 400;
constexpr std::uint64_t kGatherNumbers = 0x67617468;

/// Interleaves the bits, so that numbers in a row fill squares of the picture.
std::uint32_t curve_index(std::uint32_t x, std::uint32_t y) {
    const auto spread = [](std::uint32_t v) {
        v = (v | v << 8) & 0x00ff00ffu;
        v = (v | v << 4) & 0x0f0f0f0fu;
        v = (v | v << 2) & 0x33333333u;
        return (v | v << 1) & 0x55555555u;
    };
    return spread(x & 0xffffu) | spread(y & 0xffffu) << 1;
}

/// A millionfold sum of such numbers is finite. What is not a number has no part in it.
glm::vec3 summable(const glm::vec3& light) {
    constexpr float kLargest = 1e28f;
    glm::vec3 result(0.f);
    for (std::size_t c = 0; c < 3; ++c)
        if (!std::isnan(light[c]))
            result[c] = std::clamp(light[c], -kLargest, kLargest);
    return result;
}

/// What one ray from a seen point says of its patch.
struct GatheredSample {
    LightPlaces places;
    glm::vec3 gathered{0.f}, solved{0.f};
    std::uint32_t prior = 0; ///< look and side
    std::optional<std::uint32_t> lobe;
    glm::vec3 lobe_open{0.f}, lobe_correction{0.f};
    glm::vec3 point{0.f}, origin{0.f}; ///< where the ray began, and one corner of its patch
    bool is_flat = true;
};

/// Sums over what the camera sees of each place of light, each look and each patch's lobe.
class GatheredSums {
  public:
    GatheredSums(std::size_t places, std::size_t looks, std::size_t lobes)
        : of_places_(places), has_enough_(places, false), of_lobes_(lobes), of_looks_(2 * looks),
          lobes_of_looks_(2 * looks) {}

    void add(const GatheredSample& sample) {
        for (std::size_t k = 0; k < 3; ++k)
            if (const float weight = sample.places.weights[k]; weight > 0)
                of_places_[sample.places.places[k]].add(weight, sample.gathered, sample.solved, sample.prior);
        if (sample.is_flat)
            moments(moments_of_places_, of_places_.size(), sample.places.places[0], sample.origin)
                .add(sample.point, luminance(sample.gathered));
        of_looks_[sample.prior].add(1, sample.gathered, sample.solved, sample.prior);
        ++rays_;
        if (!sample.lobe)
            return;
        of_lobes_[*sample.lobe].add(1, sample.lobe_correction, sample.lobe_open, sample.prior);
        moments(moments_of_lobes_, of_lobes_.size(), *sample.lobe, sample.origin)
            .add(sample.point, luminance(sample.lobe_open + sample.lobe_correction));
        lobes_of_looks_[sample.prior].add(1, sample.lobe_correction, sample.lobe_open, sample.prior);
        ++rays_;
    }
    std::uint64_t rays() const { return rays_; }
    /// Of places as they were at the end of the last pass, so that all of a patch is gathered or nothing.
    bool enough(const LightPlaces& places) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (places.weights[k] > 0 && !has_enough_[places.places[k]])
                return false;
        return true;
    }

    void correct(SurfaceShading& surfaces) const {
        for (std::size_t place = 0; place < of_places_.size(); ++place)
            if (const Sum& sum = of_places_[place]; sum.weight > 0)
                surfaces.set_light(std::uint32_t(place),
                                   corrected(surfaces.light(std::uint32_t(place)), sum, ratio(of_looks_[sum.prior])));
    }

    void give_gradients(SurfaceShading& surfaces) const {
        for (std::size_t place = 0; place < moments_of_places_.number.size(); ++place)
            if (const std::uint32_t number = moments_of_places_.number[place])
                surfaces.set_gradient(std::uint32_t(place), moments_of_places_.moments[number - 1].gradient());
    }

    void end_pass() {
        for (std::size_t place = 0; place < of_places_.size(); ++place)
            has_enough_[place] = of_places_[place].weight >= kEnough;
    }

    /// To be called after one ray a pixel.
    void tell_large_patches() {
        for (Sum& sum : of_lobes_)
            sum.is_large = sum.weight >= kEnough;
    }

    /// All but those of large patches.
    void give_lobes(GlossShading& gloss) const {
        for (std::size_t lobe = 0; lobe < of_lobes_.size(); ++lobe)
            if (const Sum& sum = of_lobes_[lobe]; sum.weight > 0 && !sum.is_large) {
                const LookSum& all = lobes_of_looks_[sum.prior];
                const glm::dvec3 prior = kLobesOfPrior * all.gathered / all.weight,
                                 correction = (glm::dvec3(sum.gathered) + prior) / (double(sum.weight) + kLobesOfPrior);
                gloss.set_light_of_patch(std::uint32_t(lobe),
                                         glm::max(sum.solved / sum.weight + glm::vec3(correction), glm::vec3(0.f)),
                                         moments_of_lobes_.moments[moments_of_lobes_.number[lobe] - 1].gradient());
            }
    }

  private:
    /// Of places and lobes, of which there are many, in single precision.
    template <typename Vector>
    struct SumOf {
        Vector gathered{0}, solved{0};
        typename Vector::value_type weight = 0;
        std::uint32_t prior = 0;
        bool is_large = false;
        void add(float w, const glm::vec3& of_ray, const glm::vec3& of_solution, std::uint32_t of_prior) {
            gathered += Vector(w * of_ray);
            solved += Vector(w * of_solution);
            weight += w;
            prior = of_prior;
        }
    };
    using Sum = SumOf<glm::vec3>;
    using LookSum = SumOf<glm::dvec3>;

    static glm::dvec3 ratio(const LookSum& sum) {
        glm::dvec3 result(1.);
        for (std::size_t c = 0; c < 3; ++c)
            if (sum.solved[c] > 0) {
                const double prior = kRaysOfPrior * sum.solved[c] / sum.weight;
                result[c] = (sum.gathered[c] + prior) / (sum.solved[c] + prior);
            }
        return result;
    }
    /// What was solved as black has nothing to scale: it becomes what was gathered.
    static glm::vec3 corrected(const glm::vec3& light, const Sum& sum, const glm::dvec3& ratio_of_look) {
        glm::vec3 result(0.f);
        const double rays = double(sum.weight) + kRaysOfPrior;
        for (std::size_t c = 0; c < 3; ++c) {
            const double mean = double(sum.solved[c]) / double(sum.weight);
            const double gathered = double(sum.gathered[c]) + kRaysOfPrior * mean * ratio_of_look[c];
            result[c] = float(mean > 0 ? double(light[c]) * gathered / (mean * rays)
                                       : double(sum.gathered[c]) / double(sum.weight));
        }
        return result;
    }

    /// Of the places that are seen.
    struct Moments {
        std::vector<std::uint32_t> number; ///< from 1; 0: not seen
        std::vector<PatchMoments> moments;
    };
    static PatchMoments& moments(Moments& all, std::size_t places, std::uint32_t place, const glm::vec3& origin) {
        if (all.number.empty())
            all.number.assign(places, 0);
        if (all.number[place] == 0) {
            all.moments.emplace_back(origin);
            all.number[place] = std::uint32_t(all.moments.size());
        }
        return all.moments[all.number[place] - 1];
    }

    Moments moments_of_places_, moments_of_lobes_;
    std::vector<Sum> of_places_;
    std::vector<bool> has_enough_;
    std::vector<Sum> of_lobes_;
    std::vector<LookSum> of_looks_, lobes_of_looks_;
    std::uint64_t rays_ = 0;
};

class Gathering {
  public:
    Gathering(const ShadedScene& scene, const ReliefSurfaces& relief, const CameraFrame& frame,
              const PictureOptions& options, const IncomingRadiance& incoming, const Environment& environment,
              const SurfaceShading& surfaces, const GlossShading& gloss)
        : scene_(scene), relief_(relief), frame_(frame), options_(options), incoming_(incoming),
          environment_(environment), surfaces_(surfaces), gloss_(gloss) {}

    /// By one ray a pixel of a row: of what the camera sees and `sums` knows too little of.
    std::vector<GatheredSample> row(int pass, int y, const GatheredSums& sums) const {
        std::vector<PathNumbers> numbers;
        std::vector<CameraHit> hits;
        const std::uint64_t seed = hash64(options_.seed ^ hash64(kGatherNumbers + std::uint64_t(pass)));
        for (int x = 0; x < options_.width; ++x) {
            numbers.emplace_back(seed, curve_index(std::uint32_t(x), std::uint32_t(y)));
            const glm::vec2 place = numbers.back().pair();
            hits.emplace_back().direction = frame_.direction(float(x) + place.x, float(y) + place.y);
        }
        relief_.first_hits(hits);
        std::vector<GatheredSample> samples;
        ShadingScratch scratch;
        for (std::size_t k = 0; k < hits.size(); ++k) {
            if (!hits[k].shows_surface(incoming_.ground_distance(frame_.position, hits[k].direction)))
                continue;
            const SurfacePoint at = surfaces_.point(frame_.position, hits[k]);
            if (const LightPlaces places = surfaces_.places(at); !sums.enough(places))
                samples.push_back(from(at, places, hits[k], numbers[k], scratch));
        }
        return samples;
    }

  private:
    GatheredSample from(const SurfacePoint& at, const LightPlaces& places, const CameraHit& hit, PathNumbers& numbers,
                        ShadingScratch& scratch) const {
        const PatchScene& patches = *scene_.patches;
        const Optics& optics = patches.optics[patches.patches[at.patch].optics];
        GatheredSample sample;
        sample.places = places;
        sample.point = at.point;
        sample.origin = patches.positions[patches.triangles[patches.patches[at.patch].first_triangle].x];
        sample.is_flat = !at.smooth;
        sample.solved = summable(surfaces_.solved(at));
        sample.prior = 2 * (scene_.looks.empty() ? 0 : scene_.triangle_look[at.triangle]) + !at.front;
        const glm::vec2 scattered = numbers.pair(), mirrored = numbers.pair();
        const float choice = numbers.single();
        const SampleIndex index{0, 1, std::uint32_t(hash64(numbers.independent() * 4294967296.f))};
        sample.gathered = scattered_light(at, optics, choice, scattered, index, scratch);
        sample.lobe = gloss_.lobe_of_patch(at);
        if (sample.lobe) {
            sample.lobe_open = summable(gloss_.open_light(at, hit.direction));
            sample.lobe_correction = summable(gloss_.correction(at, hit.direction, mirrored, index, scratch));
        }
        return sample;
    }

    /// One ray of the cosine lobe before or behind the surface.
    glm::vec3 scattered_light(const SurfacePoint& at, const Optics& optics, float choice, const glm::vec2& place,
                              SampleIndex index, ShadingScratch& scratch) const {
        const float reflected = luminance(optics.reflectance), transmitted = luminance(optics.transmittance);
        if (!(reflected + transmitted > 0))
            return glm::vec3(0.f);
        const float share = reflected / (reflected + transmitted);
        const glm::vec3 normal = at.relief ? at.relief->mesh_normal : at.normal;
        const bool before = choice < share;
        const glm::vec3 direction = about_axis(cosine_direction(place), before ? normal : -normal);
        const glm::vec3 seen = summable(incoming_.along(at.point, direction, index, scratch)
                                            .value_or(lat_long_radiance(environment_.remainder, direction)));
        return seen * (before ? optics.reflectance / share : optics.transmittance / (1 - share));
    }

    const ShadedScene& scene_;
    const ReliefSurfaces& relief_;
    const CameraFrame& frame_;
    const PictureOptions& options_;
    const IncomingRadiance& incoming_;
    const Environment& environment_;
    const SurfaceShading& surfaces_;
    const GlossShading& gloss_;
};

} // namespace

void gather_for_camera(const ShadedScene& scene, const ReliefSurfaces& relief, const CameraFrame& frame,
                       const PictureOptions& options, const IncomingRadiance& incoming, const Environment& environment,
                       SurfaceShading& surfaces, GlossShading& gloss, Progress& progress, WorkReport& report) {
    const int rays = gather_rays_of(options);
    if (rays == 0)
        return;
    if (!options.pixel_shadows) {
        report.skips.push_back({"final gathering", "shadows are not tested per pixel",
                                std::to_string(rays) + " rays a pixel; patches keep their mean light"});
        return;
    }
    const Gathering gathering(scene, relief, frame, options, incoming, environment, surfaces, gloss);
    GatheredSums sums(surfaces.light_count(), std::max<std::size_t>(scene.looks.size(), 1), gloss.lobe_count());
    progress.begin("gathering light where the camera looks", std::size_t(options.height) * std::size_t(rays));
    for (int pass = 0; pass < rays; ++pass) {
        const std::uint64_t before = sums.rays();
        for (int first = 0; first < options.height; first += kRowsAtOnce) {
            std::vector<std::vector<GatheredSample>> rows(
                static_cast<std::size_t>(std::min(kRowsAtOnce, options.height - first)));
            parallel_blocks(rows.size(), 1, [&](std::size_t begin, std::size_t end) {
                progress.throw_if_stopped();
                for (std::size_t row = begin; row < end; ++row)
                    rows[row] = gathering.row(pass, first + int(row), sums);
                progress.advance(end - begin);
            });
            for (const std::vector<GatheredSample>& row : rows)
                for (const GatheredSample& sample : row)
                    sums.add(sample);
        }
        if (pass == 0)
            sums.tell_large_patches();
        sums.end_pass();
        if (sums.rays() == before) {
            report.skips.push_back({"gathering on", "all that is in view has rays enough",
                                    std::to_string(rays - pass) + " of " + std::to_string(rays) + " rays a pixel"});
            break;
        }
    }
    sums.correct(surfaces);
    sums.give_gradients(surfaces);
    sums.give_lobes(gloss);
    report.counts.push_back({"gathering rays", sums.rays()});
}

} // namespace kokage
