#include "reflection/maps/table_baker.h"
#include "common/environment/split_lights.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/lobe_lights.h"
#include "reflection/maps/split_surroundings.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>

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

constexpr int kLeastColumns = 400;

/// Measured on a smooth image beside brute force (table_baker_test.cpp): 0.45 of 255 at 128 columns, 1.1 at 64, 6.3 at
/// 16; it grows a little faster than pixels do.
std::string coarse_image_warning(int columns) {
    char error[32];
    std::snprintf(error, sizeof error, "%.1g", 0.45 * std::pow(128.0 / columns, 1.27));
    return "the image has " + std::to_string(columns) +
           " columns: the method 'table' interpolates between its pixels, and what it filters is about " + error +
           " of 255 off (from " + std::to_string(kLeastColumns) +
           " columns on it isn't); give a larger image, or take the method spectral";
}

class TableBaker final : public Baker {
  public:
    TableBaker(const TexelLayout& layout, const TableBakerSettings& settings, WorkReport& report, Progress& progress)
        : layout_(layout), table_(load_or_make(layout, settings, report, progress)), lobes_(layout_),
          least_spread_(least_spread(layout_)), as_published_(settings.table.weights == TableWeights::paper) {
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
        const Image& image = surroundings.remainder;
        WorkReport unused;
        SplitSurroundings split = split_surroundings(surroundings, least_spread_, as_published_ ? unused : report);
        if (as_published_ && !split.of_image.empty()) {
            split.of_image.clear();
            split.remainder = image;
            report.warnings.push_back("the image has lights that the domes see or miss by chance, and the weights "
                                      "'paper' split none off; with other weights, or the method spectral, they are "
                                      "right");
        }
        if (image.width < kLeastColumns)
            report.warnings.push_back(coarse_image_warning(image.width));
        Stopwatch watch;
        const DomeLight light = light_on_domes(split.remainder);
        report.stages.push_back({"sampling the domes", watch.cpu(), watch.wall()});
        watch.restart();
        table_.filter(light, filtered, progress);
        report.stages.push_back({"filtering by the table", watch.cpu(), watch.wall()});
        constexpr double kNegligible = 1e-6; // of the mean
        add_lights(split, lobes_, {}, float(kNegligible * luminance_integral(image) / (4 * kPiDouble)), filtered,
                   report);
        for (glm::vec3& value : filtered)
            value = glm::min(value, glm::vec3(std::numeric_limits<float>::max()));
        report.counts.push_back({"texels", layout_.size()});
    }

  private:
    TexelLayout layout_;
    WeightTable table_;
    LobeLights lobes_;
    double least_spread_;
    bool as_published_; ///< nothing is split off
};

} // namespace

std::unique_ptr<Baker> table_baker(const TexelLayout& layout, const TableBakerSettings& settings, WorkReport& report,
                                   Progress& progress) {
    return std::make_unique<TableBaker>(layout, settings, report, progress);
}

} // namespace kokage
