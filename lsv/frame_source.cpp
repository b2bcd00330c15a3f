#include "lsv/frame_source.h"
