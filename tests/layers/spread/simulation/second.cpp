#include <cholmod.h>
