#include "kalman_tracker_code.h"
#include "filter_code.h"
