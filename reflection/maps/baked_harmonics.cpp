#include "reflection/maps/baked_harmonics.h"
#include "common/directions/spherical_harmonics.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/harmonics_file.h"

namespace kokage {
namespace {

class BakedHarmonics final : public BakedMap {
  public:
    explicit BakedHarmonics(const HarmonicsSettings& settings) : settings_(settings) {}
    const TexelLayout& layout() const override { return nothing_; }
    std::uint64_t bytes() const override { return sh_count(settings_.bands) * sizeof(glm::vec3); }
    void bake(const Environment& surroundings, Baker*, WorkReport& report, Progress& progress) override {
        const Stopwatch watch;
        progress.begin("projecting on harmonics", 0);
        harmonics_ = harmonics_of(surroundings, settings_);
        report.stages.push_back({"projecting on harmonics", watch.cpu(), watch.wall()});
        report.counts.push_back({"coefficients", harmonics_.coefficients.size()});
        report.counts.push_back({"lights listed", harmonics_.lights.size()});
    }
    std::function<void()> packed(const std::filesystem::path& path, const std::string& made_from,
                                 WorkReport&) const override {
        return [=, harmonics = harmonics_] { write_harmonics(path, harmonics, made_from); };
    }

  private:
    HarmonicsSettings settings_;
    TexelLayout nothing_;
    Harmonics harmonics_;
};

} // namespace

std::unique_ptr<BakedMap> make_baked_harmonics(const HarmonicsSettings& settings) {
    return std::make_unique<BakedHarmonics>(settings);
}

} // namespace kokage
