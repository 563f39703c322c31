#ifndef BlockRun_h
#define BlockRun_h

class vtkAlgorithm;

/**
 * Tells whether a filter's run is one on the blocks of a collection. The executive then calls
 * RequestData for one block after the other, as often as this process has blocks: what all
 * processes have to do at once has no place there. The filter must outlive this object.
 */
class BlockRun
{
public:
  explicit BlockRun(vtkAlgorithm* filter);
  BlockRun(const BlockRun&) = delete;
  BlockRun& operator=(const BlockRun&) = delete;

  /** Whether the input of the present run, or the last one, is a collection. */
  bool HasBlocks() const { return this->Blocks; }

  /** Runs under way: that on a collection holds one on each of its blocks. */
  int Depth() const { return this->Running; }

private:
  void Starts();
  void Ends();

  vtkAlgorithm* Filter;
  int Running = 0;
  bool Blocks = false;
};

#endif
