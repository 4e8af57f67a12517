#include "reflection/maps/table_baker.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/lobe_over_cone.h"

#include <limits>
#include <optional>
#include <stdexcept>

namespace kokage {

namespace {

WeightTable load_or_make(const TexelLayout& layout, const TableBakerSettings& settings, WorkReport& report,
                         Progress& progress) {
    const Stopwatch watch;
    std::error_code ignored;
    if (!settings.stored_table.empty() && std::filesystem::exists(settings.stored_table, ignored)) {
        WeightTable table = WeightTable::load(settings.stored_table, layout, settings.table);
        report.stages.push_back({"reading the weight table", watch.cpu(), watch.wall()});
        return table;
    }
    WeightTable table(layout, settings.table, progress);
    report.stages.push_back({"making the weight table", watch.cpu(), watch.wall()});
    if (!settings.stored_table.empty()) {
        const Stopwatch writing;
        table.save(settings.stored_table);
        report.stages.push_back({"writing the weight table", writing.cpu(), writing.wall()});
    }
    return table;
}

class TableBaker final : public Baker {
  public:
    TableBaker(const TexelLayout& layout, const TableBakerSettings& settings, WorkReport& report, Progress& progress)
        : layout_(layout), table_(load_or_make(layout, settings, report, progress)) {
        report.counts.push_back({"weights stored", table_.entries()});
        report.counts.push_back({"bytes of the weight table", table_.bytes()});
        if (table_.unshared_bytes() > 2 * table_.bytes())
            report.skips.push_back({"weights of symmetric texels", "they share rows of the table",
                                    std::to_string((table_.unshared_bytes() - table_.bytes()) / 1'000'000) + " MB"});
    }

    void bake(const Environment& surroundings, std::span<glm::vec3> filtered, WorkReport& report,
              Progress& progress) override {
        if (filtered.size() != layout_.size())
            throw std::invalid_argument("as many places as the layout has texels are needed");
        const Stopwatch sampling;
        const DomeLight light = light_on_domes(surroundings.remainder);
        report.stages.push_back({"sampling the domes", sampling.cpu(), sampling.wall()});
        const Stopwatch summing;
        table_.filter(light, filtered, progress);
        add_lights(surroundings.distant_lights, filtered, progress);
        report.stages.push_back({"filtering by the table", summing.cpu(), summing.wall()});
        report.counts.push_back({"texels", layout_.size()});
        report.counts.push_back({"lights", surroundings.distant_lights.size()});
    }

  private:
    void add_lights(std::span<const DistantLight> lights, std::span<glm::vec3> filtered, Progress& progress) const {
        if (lights.empty())
            return;
        parallel_blocks(layout_.size(), 1024, [&](std::size_t begin, std::size_t end) {
            progress.throw_if_stopped();
            for (std::size_t t = begin; t < end; ++t)
                for (const DistantLight& light : lights) {
                    const Lobe lobe{layout_.kind, double(layout_.parameters[t])};
                    const glm::dvec3 radiance =
                        glm::dvec3(filtered[t]) +
                        light_through_lobe(light, lobe, glm::normalize(glm::dvec3(layout_.directions[t])));
                    filtered[t] = glm::vec3(glm::min(radiance, glm::dvec3(double(std::numeric_limits<float>::max()))));
                }
        });
    }

    TexelLayout layout_;
    WeightTable table_;
};

} // namespace

std::unique_ptr<Baker> table_baker(const TexelLayout& layout, const TableBakerSettings& settings, WorkReport& report,
                                   Progress& progress) {
    return std::make_unique<TableBaker>(layout, settings, report, progress);
}

} // namespace kokage
