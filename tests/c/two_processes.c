#include "two_processes.h"

#include <string.h>
#include <threads.h>

/* One message on its way, each way. */
typedef struct
{
  mtx_t mutex;
  cnd_t changed;
  const int64_t* numbers[2];
  size_t length[2];
} Link;

typedef struct
{
  Link* link;
  size_t process;
} End;

static bool send_numbers(void* user, size_t to, const int64_t* numbers, size_t length)
{
  End* end = user;
  Link* link = end->link;
  mtx_lock(&link->mutex);
  link->numbers[to] = numbers;
  link->length[to] = length;
  cnd_broadcast(&link->changed);
  while (link->numbers[to])
  {
    cnd_wait(&link->changed, &link->mutex);
  }
  mtx_unlock(&link->mutex);
  return true;
}

static bool receive_numbers(void* user, size_t from, int64_t* numbers, size_t length)
{
  End* end = user;
  Link* link = end->link;
  (void)from;
  mtx_lock(&link->mutex);
  while (!link->numbers[end->process])
  {
    cnd_wait(&link->changed, &link->mutex);
  }
  const bool fits = link->length[end->process] == length;
  if (fits)
  {
    memcpy(numbers, link->numbers[end->process], length * sizeof *numbers);
  }
  link->numbers[end->process] = NULL;
  cnd_broadcast(&link->changed);
  mtx_unlock(&link->mutex);
  return fits;
}

/* A process on a thread of its own. */
typedef struct
{
  Work* work;
  void* of_process;
  End end;
} Member;

static int run(void* argument)
{
  Member* member = argument;
  const midsurface_exchange exchange = {
    .processes = 2,
    .process = member->end.process,
    .send = send_numbers,
    .receive = receive_numbers,
    .user = &member->end,
  };
  member->work(member->of_process, &exchange);
  return 0;
}

bool run_two(Work* work, void* of_processes[2])
{
  Link link = { .numbers = { NULL, NULL } };
  Member members[2];
  for (size_t i = 0; i < 2; i++)
  {
    members[i] = (Member){ work, of_processes[i], { &link, i } };
  }
  mtx_init(&link.mutex, mtx_plain);
  cnd_init(&link.changed);
  thrd_t other;
  const bool starts = thrd_create(&other, run, &members[1]) == thrd_success;
  if (starts)
  {
    run(&members[0]);
    thrd_join(other, NULL);
  }
  cnd_destroy(&link.changed);
  mtx_destroy(&link.mutex);
  return starts;
}
