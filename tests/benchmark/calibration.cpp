#include "tests/benchmark/calibration.h"
#include "common/services/random.h"
#include "common/services/stopwatch.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace kokage {

double calibration_seconds() {
    std::vector<double> table(1 << 19);
    for (std::size_t i = 0; i < table.size(); ++i)
        table[i] = double(i);
    double best = 1e300;
    volatile double keep = 0;
    for (int repeat = 0; repeat < 3; ++repeat) {
        const Stopwatch watch;
        std::uint64_t key = 1;
        double sum = 0;
        for (int i = 0; i < 20'000'000; ++i) {
            key = hash64(key);
            sum = std::sqrt(sum + table[key & (table.size() - 1)]);
        }
        keep = keep + sum;
        best = std::min(best, watch.cpu());
    }
    return best;
}

} // namespace kokage
