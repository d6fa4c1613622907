/*
 * File: ert_main.c
 *
 * Written by hand in the shape that Embedded Coder gives a model 'acc': no coder
 * was run. It computes what pd_acc.c beside it does.
 *
 * Code interface packaging: reusable function
 */

#include "acc.h"

/* Shows how a main program of a target calls the model; it is not part of the model. */
static RT_MODEL_acc_T acc_M_;
static RT_MODEL_acc_T *const acc_MPtr = &acc_M_;
static DW_acc_T acc_DW;
static ExtU_acc_T acc_U;
static ExtY_acc_T acc_Y;

void rt_OneStep(RT_MODEL_acc_T *const acc_M);
void rt_OneStep(RT_MODEL_acc_T *const acc_M)
{
  acc_step(acc_M);
}

int main(void)
{
  acc_MPtr->defaultParam = &acc_P;
  acc_MPtr->dwork = &acc_DW;
  acc_MPtr->inputs = &acc_U;
  acc_MPtr->outputs = &acc_Y;
  acc_initialize(acc_MPtr);
  while (rtmGetErrorStatus(acc_MPtr) == (const char_T *)0) {
    rt_OneStep(acc_MPtr);
  }

  acc_terminate(acc_MPtr);
  return 0;
}
