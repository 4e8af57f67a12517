#include "trees/tree.h"
