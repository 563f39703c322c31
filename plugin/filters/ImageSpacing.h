#ifndef ImageSpacing_h
#define ImageSpacing_h

#include <cstddef>
#include <string>

/** An image's spacing, and what is meant by it where the file it comes from is known to be wrong.
 */
class ImageSpacing
{
public:
  ImageSpacing(const int wholeExtent[6], const double spacing[3]);

  /** Whether z is the height of the whole image where a voxel's was meant. */
  bool IsStretched() const { return this->Stretched; }
  /** The spacing that is meant; the given one where it is not stretched. */
  const double* GetMeant() const { return this->Meant; }

  /**
   * What is wrong and what can be done about it, for a user.
   * @param zOrigin the image's origin along z.
   */
  std::string Explain(double zOrigin) const;

private:
  size_t Dimensions[3];
  double Given[3];
  double Meant[3];
  bool Stretched;
};

#endif
