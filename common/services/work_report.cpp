#include "common/services/work_report.h"

namespace kokage {

void WorkReport::append(const WorkReport& other) {
    stages.insert(stages.end(), other.stages.begin(), other.stages.end());
    counts.insert(counts.end(), other.counts.begin(), other.counts.end());
    skips.insert(skips.end(), other.skips.begin(), other.skips.end());
    warnings.insert(warnings.end(), other.warnings.begin(), other.warnings.end());
}

} // namespace kokage
