#include "tests/benchmark/foliage_benchmark.h"
