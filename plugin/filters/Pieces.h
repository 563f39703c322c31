#ifndef Pieces_h
#define Pieces_h

#include "vtkSmartPointer.h"

class vtkImageData;
class vtkInformation;
class BlockRun;
struct ChosenArray;

/**
 * Who works where the pipeline is updated in pieces, one a process. All processes have to call
 * these functions at once.
 */
namespace Pieces
{
/** Whether the output that `output` describes is asked for in pieces. */
bool AreMany(vtkInformation* output);

/** Whether the pieces are asked for by as many processes, which can send each other theirs. */
bool AreShared(vtkInformation* output);

/** Whether the piece asked for is the first, or the only one. */
bool IsFirst(vtkInformation* output);

/**
 * What RequestData has to return after a run that ended with `result`: where one process stops,
 * others further down the pipeline may wait for it, so its message has to do and all go on.
 */
int Result(vtkInformation* output, int result);

/**
 * Whether this process works by itself, on a block of its own or as the first on all, where the
 * pieces are not AreShared.
 */
bool HasToWork(const BlockRun& run, vtkInformation* output);

/**
 * The image that the pieces of the array `chosen` make up, without any array; null where all pieces
 * lack it. `piece` may be empty, and comes from `source`. `association` becomes that of the array.
 * @throws std::runtime_error in all processes where the pieces do not fit together.
 */
vtkSmartPointer<vtkImageData> Frame(
  vtkInformation* source, vtkImageData* piece, const ChosenArray& chosen, int& association);
} // namespace Pieces

#endif
