#include "common/services/progress.h"
#include "common/services/error.h"

namespace kokage {

void Progress::throw_if_stopped() const {
    if (stop_requested())
        throw Stopped();
}

Progress& silent_progress() {
    static Progress silent;
    return silent;
}

} // namespace kokage
