#include "reflection/maps/baked_harmonics.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/harmonics_file.h"

namespace kokage {
namespace {

class BakedHarmonics final : public BakedMap {
  public:
    explicit BakedHarmonics(const MapSettings& settings) : plan_(plan_map(settings)), settings_(settings.harmonics) {}
    const TexelLayout& layout() const override { return nothing_; }
    const MapPlan& plan() const override { return plan_; }
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
    MapPlan plan_;
    HarmonicsSettings settings_;
    TexelLayout nothing_;
    Harmonics harmonics_;
};

} // namespace

std::unique_ptr<BakedMap> make_baked_harmonics(const MapSettings& settings) {
    return std::make_unique<BakedHarmonics>(settings);
}

} // namespace kokage
