#pragma once

namespace kokage {

/// Has freed memory kept for what comes next instead of handed back to the system at once: stages that follow each
/// other use as much again, and pages that the system gives anew cost more than what is computed in them (a seventh of
/// the time of a shading, measured). For programs, not for libraries; does nothing where the C library has no such
/// switch.
void keep_freed_memory();

} // namespace kokage
