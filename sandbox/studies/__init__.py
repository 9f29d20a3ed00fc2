"""Studies: claims, figures, comparisons, maps, the work-precision chart, maps of failure, the experiment."""
