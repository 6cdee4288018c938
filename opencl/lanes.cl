__kernel void lanes_visibility(void){}
__kernel void lanes_accumulate(void){}
__kernel void lanes_nearest(void){}
