#include "estimation/output/step_json.h"
