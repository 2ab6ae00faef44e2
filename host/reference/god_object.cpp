#include "host/reference/god_object.h"

namespace forceshade::reference {

FORCESHADE_GOD_OBJECT(, float)
FORCESHADE_GOD_OBJECT(, double)

} // namespace forceshade::reference
