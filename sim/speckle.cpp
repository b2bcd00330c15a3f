#include "sim/speckle.h"
