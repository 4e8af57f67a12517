#include "common/environment/light_regions.h"
#include "common/environment/lat_long.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kokage {
namespace {

double brightness(const float* pixel) {
    return (double(pixel[0]) + double(pixel[1]) + double(pixel[2])) / 3;
}

/// Means of the pixels that are at most as bright as a threshold.
struct DimPart {
    glm::dvec3 integral{0.0};
    double solid_angle = 0;
};

DimPart dim_part(const Image& image, double threshold) {
    DimPart part;
    for (int y = 0; y < image.height; ++y) {
        glm::dvec3 row(0);
        std::size_t count = 0;
        for (int x = 0; x < image.width; ++x)
            if (const float* p = image.at(x, y); brightness(p) <= threshold) {
                row += glm::dvec3(p[0], p[1], p[2]);
                ++count;
            }
        const double solid_angle = pixel_solid_angle(y, image.width, image.height);
        part.integral += solid_angle * row;
        part.solid_angle += solid_angle * double(count);
    }
    return part;
}

double mean_of_channels(const glm::dvec3& color) {
    return (color.r + color.g + color.b) / 3;
}

/// How many columns apart pixel centres of two rows may be to lie within `gap` (radians) of each other; -1 = never.
/// Spherical law of cosines; at least 1 for neighbouring rows, all of them where rows meet at a pole.
int column_reach(const Image& image, int row_a, int row_b, double gap) {
    const double step = kPiDouble / image.height, a = (row_a + 0.5) * step, b = (row_b + 0.5) * step;
    const bool neighbours = std::abs(row_a - row_b) <= 1;
    if (row_a == row_b && (row_a == 0 || row_a == image.height - 1))
        return image.width;
    int reach = neighbours ? 1 : -1;
    if (std::abs(a - b) <= gap) {
        const double cosine = (std::cos(gap) - std::cos(a) * std::cos(b)) / (std::sin(a) * std::sin(b));
        const double azimuth = std::acos(std::clamp(cosine, -1.0, 1.0));
        reach = std::max(reach, int(std::min(azimuth / (2 * kPiDouble) * image.width, double(image.width))));
    }
    return reach;
}

int row_reach(const Image& image, double gap) {
    return std::max(1, int(gap / kPiDouble * image.height));
}

class UnionFind {
  public:
    explicit UnionFind(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), std::size_t(0));
    }
    std::size_t find(std::size_t i) {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    /// The lower index becomes the representative.
    void join(std::size_t a, std::size_t b) {
        a = find(a), b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

  private:
    std::vector<std::size_t> parent_;
};

/// Joins a run with all runs [begin, end) of one row that come within `reach` columns of it, around the seam too.
void join_with_row(UnionFind& sets, const std::vector<PixelRun>& runs, std::size_t run, std::size_t begin,
                   std::size_t end, int reach, int width) {
    for (const int shift : {-width, 0, width}) {
        const int low = runs[run].begin - reach + shift, high = runs[run].end - 1 + reach + shift;
        if (high < 0 || low >= width)
            continue;
        auto first = std::partition_point(runs.begin() + std::ptrdiff_t(begin), runs.begin() + std::ptrdiff_t(end),
                                          [&](const PixelRun& other) { return other.end - 1 < low; });
        for (; first != runs.begin() + std::ptrdiff_t(end) && first->begin <= high; ++first)
            sets.join(run, std::size_t(first - runs.begin()));
    }
}

} // namespace

BrightPixels find_bright_pixels(const Image& image, double brightness_ratio) {
    BrightPixels bright;
    DimPart dim = dim_part(image, INFINITY);
    bright.total = mean_of_channels(dim.integral);
    for (bool first = true;; first = false) {
        bright.background_color = dim.solid_angle > 0 ? dim.integral / dim.solid_angle : glm::dvec3(0);
        bright.background = mean_of_channels(bright.background_color);
        const double threshold = brightness_ratio * bright.background;
        // The threshold only falls, so this ends; a hair's breadth is not worth another pass over a large image.
        if (!first && threshold >= bright.threshold * 0.999)
            break;
        bright.threshold = threshold;
        dim = dim_part(image, threshold);
    }
    std::vector<PixelRun> rows;
    for (int y = 0; y < image.height; ++y)
        rows.push_back({y, 0, image.width});
    bright.runs = brighter_runs(image, rows, bright.threshold);
    return bright;
}

std::vector<PixelRun> brighter_runs(const Image& image, const std::vector<PixelRun>& within, double threshold) {
    std::vector<PixelRun> runs;
    for (const PixelRun& run : within)
        for (int x = run.begin; x < run.end; ++x) {
            const int begin = x;
            while (x < run.end && brightness(image.at(x, run.y)) > threshold)
                ++x;
            if (x > begin)
                runs.push_back({run.y, begin, x});
        }
    return runs;
}

std::vector<LightRegion> connect_regions(const Image& image, const std::vector<PixelRun>& runs, double background,
                                         double gap_degrees) {
    const double gap = gap_degrees * kPiDouble / 180;
    std::vector<std::size_t> row_begin(std::size_t(image.height) + 1);
    for (int y = 0; y <= image.height; ++y)
        row_begin[std::size_t(y)] =
            std::size_t(std::partition_point(runs.begin(), runs.end(), [&](const PixelRun& run) { return run.y < y; }) -
                        runs.begin());

    UnionFind sets(runs.size());
    const int rows = row_reach(image, gap);
    for (int a = 0; a < image.height; ++a)
        for (int b = a; b <= std::min(image.height - 1, a + rows); ++b) {
            const std::size_t begin = row_begin[std::size_t(b)], end = row_begin[std::size_t(b) + 1];
            if (begin == end || row_begin[std::size_t(a)] == row_begin[std::size_t(a) + 1])
                continue;
            if (const int reach = column_reach(image, a, b, gap); reach >= 0)
                for (std::size_t run = row_begin[std::size_t(a)]; run < row_begin[std::size_t(a) + 1]; ++run)
                    join_with_row(sets, runs, run, begin, end, reach, image.width);
        }

    std::vector<LightRegion> regions;
    std::vector<std::size_t> region_of(runs.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
        const std::size_t set = sets.find(i);
        if (set == i) {
            region_of[i] = regions.size();
            regions.emplace_back();
        }
        LightRegion& region = regions[region_of[set]];
        region.runs.push_back(runs[i]);
        double sum = 0;
        for (int x = runs[i].begin; x < runs[i].end; ++x)
            sum += brightness(image.at(x, runs[i].y)) - background;
        region.excess += sum * pixel_solid_angle(runs[i].y, image.width, image.height);
    }
    return regions;
}

double least_brightness(const Image& image, const LightRegion& region) {
    double least = INFINITY;
    for (const PixelRun& run : region.runs)
        for (int x = run.begin; x < run.end; ++x)
            least = std::min(least, brightness(image.at(x, run.y)));
    return least;
}

double cone_degrees(const Image& image, const LightRegion& region) {
    glm::dvec3 mean(0);
    for (const PixelRun& run : region.runs)
        for (int x = run.begin; x < run.end; ++x)
            mean += pixel_solid_angle(run.y, image.width, image.height) * brightness(image.at(x, run.y)) *
                    pixel_direction(x, run.y, image.width, image.height);
    const double length = glm::length(mean);
    if (!(length > 0))
        return 180;
    double smallest = 1;
    for (const PixelRun& run : region.runs)
        for (int x = run.begin; x < run.end; ++x)
            smallest =
                std::min(smallest, glm::dot(mean / length, pixel_direction(x, run.y, image.width, image.height)));
    return std::acos(std::clamp(smallest, -1.0, 1.0)) * 180 / kPiDouble;
}

glm::dvec3 surrounding_color(const Image& image, const LightRegion& region, double threshold,
                             const glm::dvec3& background, double gap_degrees) {
    const double gap = gap_degrees * kPiDouble / 180;
    const int rows = row_reach(image, gap);
    // Per row, the columns near the region as a difference array: +1 where a stretch begins, -1 behind its end.
    const int top = std::max(0, region.runs.front().y - rows),
              bottom = std::min(image.height - 1, region.runs.back().y + rows);
    std::vector<std::vector<int>> near(std::size_t(bottom - top + 1));
    for (const PixelRun& run : region.runs)
        for (int y = std::max(top, run.y - rows); y <= std::min(bottom, run.y + rows); ++y) {
            const int reach = column_reach(image, run.y, y, gap);
            if (reach < 0)
                continue;
            std::vector<int>& row = near[std::size_t(y - top)];
            row.resize(std::size_t(image.width) + 1);
            const int begin = run.begin - reach, length = std::min(image.width, run.end - run.begin + 2 * reach);
            const int start = ((begin % image.width) + image.width) % image.width,
                      first_part = std::min(length, image.width - start);
            ++row[std::size_t(start)], --row[std::size_t(start + first_part)];
            if (length > first_part)
                ++row[0], --row[std::size_t(length - first_part)];
        }
    glm::dvec3 sum(0);
    double solid_angle = 0;
    for (int y = top; y <= bottom; ++y) {
        const std::vector<int>& row = near[std::size_t(y - top)];
        int cover = 0;
        for (int x = 0; x < image.width && !row.empty(); ++x) {
            cover += row[std::size_t(x)];
            const float* p = image.at(x, y);
            if (cover > 0 && brightness(p) <= threshold) {
                const double weight = pixel_solid_angle(y, image.width, image.height);
                sum += weight * glm::dvec3(p[0], p[1], p[2]);
                solid_angle += weight;
            }
        }
    }
    return solid_angle > 0 ? sum / solid_angle : background;
}

} // namespace kokage
