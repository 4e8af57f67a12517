#include "reflection/picture.h"
