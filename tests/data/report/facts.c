/* SPDX-License-Identifier: MIT
 * What a compiled model says of itself, a line each, words separated by tabs: the size of an instance, its signals
 * (with the values that set-up gives them), and how many right-hand sides its steps take. MODEL is the name of the
 * model, HEADER its header in quotes. */
#include HEADER

#include <stdio.h>

#define JOINED(a, b) a##b
#define NAME(a, b) JOINED(a, b)

static void signals(const char *kind, int count, const gic_signal *signal, const gic_real *value)
{
    for (int i = 0; i < count; ++i) {
        printf("%s\t%d\t%s\t%s\t", kind, i, signal[i].name, signal[i].unit);
        if (value)
            printf("%.15g", (double)value[i]);
        printf("\n");
    }
}

int main(void)
{
    static MODEL it;
    const gic_model *model = &NAME(MODEL, _model);
    const gic_method method[] = {GIC_RK4, GIC_AB3, GIC_AB3, GIC_AB3};
    static const char *const what[] = {"rk4", "ab3 first", "ab3 second", "ab3 third"};
    if (model->setup(&it) != GIC_OK)
        return 1;
    printf("size\t%zu\n", sizeof it);
    signals("states", model->slow_count + model->fast_count, model->state, it.state);
    signals("inputs", model->input_count, model->input, it.input);
    signals("parameters", model->parameter_count, model->parameter, it.parameter);
    signals("ports", model->port_count, model->port, NULL);
    signals("outputs", model->output_count, model->output, NULL);
    for (int i = 0; i < 4; ++i) {
        const int64_t before = it.head.rhs_count;
        if (gic_step(model, &it, GIC_R(1e-4), (int32_t)method[i]) != GIC_OK)
            return 1;
        printf("step\t%s\t%d\n", what[i], (int)(it.head.rhs_count - before));
    }
    return 0;
}
