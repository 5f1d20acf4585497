#include "estimation/synth/synth.h"
