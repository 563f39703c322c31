#ifndef ArrayValues_h
#define ArrayValues_h

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <cstddef>
#include <cstdint>

class vtkDataArray;
class vtkPolyData;

/**
 * Makes room for so many tuples, whose values are unknown. Throws std::bad_alloc where memory is
 * refused; VTK's own allocation would end the program.
 */
void AllocateTuples(vtkDataArray* array, size_t tuples);

/**
 * The values of an array as the VTK type `type`: the array's own memory, or a copy where its type
 * or layout is another one. `kept` owns them.
 */
const void* ValuesOfType(vtkDataArray* array, int type, vtkSmartPointer<vtkDataArray>& kept);

/**
 * The same for 64-bit integers, from tuple `first` on; null where there is no array, or one with
 * several components.
 */
const int64_t* WholeNumbers(
  vtkDataArray* array, vtkIdType first, vtkSmartPointer<vtkDataArray>& kept);

/** Coordinates of the points, x y z; null where there is no point. */
const double* Coordinates(vtkPolyData* data, vtkSmartPointer<vtkDataArray>& kept);

/** The point array `name`; null where there is none, or one with several components. */
const float* PointValues(vtkPolyData* data, const char* name, vtkSmartPointer<vtkDataArray>& kept);

#endif
